"""Finds the table that lists the images of a folder, and the images that it names."""

from pathlib import Path, PurePosixPath

from horizon_dl.data.readers.parsing import IMAGE_SUFFIXES
from horizon_dl.data.tables.columns import find_columns
from horizon_dl.data.tables.table import Table, read_table
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
    fitting = [path for path in files[:MOST_TABLES] if _lists_images(folder, path)]
    return fitting[0] if len(fitting) == 1 else None


def image_paths(folder: Path, names: list[str]) -> list[Path]:
    """The images that a table names: beside the table, or in the one folder of images beside it."""
    plain = [folder / name for name in names]
    if not plain or plain[0].is_file():
        return plain
    for place in (*IMAGE_FOLDERS, ""):
        # A table from another machine may hold whole paths: the end of them counts.
        for end in (PurePosixPath, _last):
            if (folder / place / end(names[0])).is_file():
                return [folder / place / end(name) for name in names]
    return plain


def _last(name: str) -> PurePosixPath:
    return PurePosixPath(PurePosixPath(name).name)


def _lists_images(folder: Path, path: Path) -> bool:
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
    return _names_an_image(folder, table, columns["image"].name)


def _names_an_image(folder: Path, table: Table, column: str) -> bool:
    name = table.texts(column)[0].replace("\\", "/")
    return name.lower().endswith(IMAGE_SUFFIXES) and image_paths(folder, [name])[0].is_file()
