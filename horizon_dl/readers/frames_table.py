"""Finds the table that lists the images of a folder, and the images that it names."""

from pathlib import Path, PurePosixPath

from horizon_dl.data.tables.columns import find_columns
from horizon_dl.data.tables.parsing import IMAGE_SUFFIXES, inside_folder
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
    return [inside_folder(table, folder, name) for name in names]


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
