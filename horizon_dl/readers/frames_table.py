"""Finds the table that lists the images of a folder, and the images that it names."""

from pathlib import Path, PurePosixPath
from unicodedata import normalize

from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.parsing import IMAGE_SUFFIXES, images_in, inside_folder
from horizon_dl.data.tables.table import read_table
from horizon_dl.errors import InputError

NAMES = ("frames.csv", "frames.tsv", "frames.txt")
SUFFIXES = {".csv", ".tsv", ".txt"}
IMAGE_FOLDERS = ("images", "image", "imgs", "img", "frames", "rgb", "data", "pictures", "photos", "cam0")
LARGEST_BYTES = 50_000_000
MOST_TABLES = 20


def frames_table(folder: Path) -> Path | None:
    """The folder's `frames.csv`, in any case of letters; else the one table of images and attitudes."""
    if not folder.is_dir():
        return None
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file())
    named = [path for path in files if path.name.lower() in NAMES]
    if named:
        return min(named, key=lambda path: NAMES.index(path.name.lower()))
    fitting = [path for path in files[:MOST_TABLES] if _lists_images(path)]
    return fitting[0] if len(fitting) == 1 else None


def image_paths(table: Path, cells: list[str]) -> list[Path]:
    """The images that a table names: beside the table, or in the one folder of images beside it.

    Raises:
        InputError: a name leaves the table's folder.
    """
    folder = table.parent
    names = [cell.replace("\\", "/").removeprefix("./") for cell in cells]
    if names and not _is_there(table, names[0]):
        # Images in a folder of another name; a table from another machine holds whole paths of which the
        # end counts.
        for place in (*IMAGE_FOLDERS, ""):
            for ends in (names, [PurePosixPath(name).name for name in names]):
                moved = [str(PurePosixPath(place, end)) for end in ends]
                if _is_there(table, moved[0]):
                    return [inside_folder(table, folder, name) for name in moved]
    paths = [inside_folder(table, folder, name) for name in names]
    return paths if names and paths[0].is_file() else _by_stem(table, names) or paths


def _by_stem(table: Path, names: list[str]) -> list[Path] | None:
    """Images that the table names without a suffix, or in other letters; None: not all are there."""
    for place in (".", *IMAGE_FOLDERS):
        images = images_in(table.parent / place)
        stems = {normalize("NFC", image.stem.lower()): image for image in images}
        wanted = [_stem(name) for name in names]
        if images and len(stems) == len(images) and all(stem in stems for stem in wanted):
            return [table.parent / place / stems[stem].name for stem in wanted]
    return None


def _stem(name: str) -> str:
    last = normalize("NFC", PurePosixPath(name).name.lower())  # a Mac writes accents as letters of their own
    return last[: -len(PurePosixPath(last).suffix)] if last.endswith(IMAGE_SUFFIXES) else last


def _is_there(table: Path, name: str) -> bool:
    try:
        return inside_folder(table, table.parent, name).is_file()
    except InputError:
        return False


def _lists_images(path: Path) -> bool:
    """Whether a table has columns of images, times and attitudes, and its first image is there."""
    if path.stat().st_size > LARGEST_BYTES:
        return False
    try:
        table = read_table(path)
    except InputError:
        return False
    columns = find_columns(table)
    attitude = {"roll", "pitch"} <= columns.keys() or {"qw", "qx", "qy", "qz"} <= columns.keys()
    if not attitude or not {"image", "time"} <= columns.keys():
        return False
    name = table.texts(columns["image"].name)[0]
    return name.lower().endswith(IMAGE_SUFFIXES) and _first_is_there(path, name)


def _first_is_there(path: Path, name: str) -> bool:
    try:
        return image_paths(path, [name])[0].is_file()
    except InputError:
        return False
