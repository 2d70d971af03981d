"""Finds the tables that list the images of a folder, and the images that they name."""

from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from unicodedata import normalize

from horizon_dl.data.tables.columns import Column
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.parsing import IMAGE_SUFFIXES, images_in, inside_folder
from horizon_dl.data.tables.table import read_table
from horizon_dl.errors import InputError

NAMES = ("frames.csv", "frames.tsv", "frames.txt")
SUFFIXES = {".csv", ".tsv", ".txt"}
IMAGE_FOLDERS = ("images", "image", "imgs", "img", "frames", "rgb", "data", "pictures", "photos", "cam0")
LARGEST_BYTES = 50_000_000
MOST_TABLES = 20


def frames_table(path: Path) -> Path | None:
    """A folder's `frames.csv`, in any case of letters; else its one table of images and attitudes.

    Of a file: itself, if it lists images and their times.
    """
    if path.is_file():
        return path if path.suffix.lower() in SUFFIXES and _listing(path) is not None else None
    files = _tables_in(path)
    named = [table for table in files if table.name.lower() in NAMES]
    if named:
        return min(named, key=lambda table: NAMES.index(table.name.lower()))
    fitting = [table for table in files[:MOST_TABLES] if _has_attitudes(_listing(table) or {})]
    return fitting[0] if len(fitting) == 1 else None


def image_lists(pictures: Path) -> list[Path]:
    """Tables of images and times, with or without attitudes, in a folder of pictures; else beside it."""
    for folder in (pictures, pictures.parent):
        tables = _tables_in(folder)[:MOST_TABLES]
        found = [table for table in tables if _listing(table, (pictures.name,)) is not None]
        if found:
            return found
    return []


def image_paths(table: Path, cells: list[str], folders: Sequence[str] = IMAGE_FOLDERS) -> list[Path]:
    """The images that a table names: beside the table, or in the one folder of images beside it.

    Args:
        table: its file.
        cells: names of the images.
        folders: names that the folder may have.

    Raises:
        InputError: a name leaves the table's folder.
    """
    folder = table.parent
    names = [cell.replace("\\", "/").removeprefix("./") for cell in cells]
    if names and not _is_there(table, names[0]):
        # Images in a folder of another name; a table from another machine holds whole paths of which the
        # end counts.
        for place in (*folders, ""):
            for ends in (names, [PurePosixPath(name).name for name in names]):
                moved = [str(PurePosixPath(place, end)) for end in ends]
                if _is_there(table, moved[0]):
                    return [inside_folder(table, folder, name) for name in moved]
    paths = [inside_folder(table, folder, name) for name in names]
    return paths if names and paths[0].is_file() else _by_stem(table, names, folders) or paths


def _by_stem(table: Path, names: list[str], folders: Sequence[str]) -> list[Path] | None:
    """Images that the table names without a suffix, or in other letters; None: not all are there."""
    for place in (".", *folders):
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


def _tables_in(folder: Path) -> list[Path]:
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file())


def _has_attitudes(columns: Mapping[str, Column]) -> bool:
    """Whether columns by role are those of a whole attitude."""
    return {"roll", "pitch"} <= columns.keys() or {"qw", "qx", "qy", "qz"} <= columns.keys()


def _listing(path: Path, folders: Sequence[str] = ()) -> dict[str, Column] | None:
    """The columns of a table that lists images and times, and of which the first image is there."""
    if path.stat().st_size > LARGEST_BYTES:
        return None
    try:
        table = read_table(path)
    except InputError:
        return None
    columns = find_columns(table)
    if not {"image", "time"} <= columns.keys():
        return None
    name = table.texts(columns["image"].name)[0]
    there = name.lower().endswith(IMAGE_SUFFIXES) and _first_is_there(path, name, folders)
    return columns if there else None


def _first_is_there(path: Path, name: str, folders: Sequence[str]) -> bool:
    try:
        return image_paths(path, [name], (*folders, *IMAGE_FOLDERS))[0].is_file()
    except InputError:
        return False
