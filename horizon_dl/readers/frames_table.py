"""Finds the tables that list the images of a folder, and the images that they name."""

import math
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from unicodedata import normalize

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.given import Given
from horizon_dl.data.regular_file import files_in
from horizon_dl.data.tables.attitude_columns import has_attitude, read_times
from horizon_dl.data.tables.columns import Column, require
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.parsing import IMAGE_SUFFIXES, images_in, inside_folder
from horizon_dl.data.tables.table import Table, read_table
from horizon_dl.data.tables.units import CAMERA_STEPS
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

NAMES = ("frames.csv", "frames.tsv", "frames.txt")
SUFFIXES = {".csv", ".tsv", ".txt"}
IMAGE_FOLDERS = ("images", "image", "imgs", "img", "frames", "rgb", "data", "pictures", "photos", "cam0")
HEAD_BYTES = 1 << 16
"""Enough of a table to see what it lists."""
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
    fitting = [table for table in files[:MOST_TABLES] if has_attitude(_listing(table) or {})]
    return fitting[0] if len(fitting) == 1 else None


def image_lists(pictures: Path) -> list[Path]:
    """Tables of the images in a folder and of their times, with or without attitudes: in it, or beside it."""
    pictures = pictures.resolve()
    for folder in (pictures, pictures.parent):
        tables = _tables_in(folder)[:MOST_TABLES]
        found = [table for table in tables if _listing(table, pictures) is not None]
        if found:
            return found
    return []


def listed_images(
    table: Table, columns: dict[str, Column], given: Given, pictures: Path | None = None
) -> tuple[list[Path], Floats, tuple[str, ...]]:
    """The images that a table lists, their times (N,) s, and notes.

    Args:
        table: with the columns.
        columns: by role.
        given: the times' unit.
        pictures: the folder of the images, if it is known.

    Raises:
        InputError: no such columns, a row without image or time, a name that leaves the table's folder.
    """
    require(table, columns, ("image", "time"))
    times_s, notes = read_times(table, columns, given, CAMERA_STEPS)
    cells = table.texts(columns["image"].name)
    for index, cell in enumerate(cells):
        if not cell or not math.isfinite(times_s[index]):
            problem = f"row {index + 1} has no image or no time"
            raise InputError(table.path, problem, "complete or remove the row")
    folders = IMAGE_FOLDERS if pictures is None else (pictures.resolve().name, *IMAGE_FOLDERS)
    return image_paths(table.path, cells, folders), times_s, notes


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
    return [path for path in files_in(folder) if path.suffix.lower() in SUFFIXES]


def _listing(path: Path, pictures: Path | None = None) -> dict[str, Column] | None:
    """The columns of a table that lists images, as far as the first is there (in a folder), and times."""
    try:
        table = read_table(path, HEAD_BYTES)
    except InputError:
        return None
    columns = find_columns(table)
    if not {"image", "time"} <= columns.keys():
        return None
    name = table.texts(columns["image"].name)[0]
    there = name.lower().endswith(IMAGE_SUFFIXES) and _first_is_there(path, name, pictures)
    return columns if there else None


def _first_is_there(path: Path, name: str, pictures: Path | None) -> bool:
    folders = IMAGE_FOLDERS if pictures is None else (pictures.name, *IMAGE_FOLDERS)
    try:
        first = image_paths(path, [name], folders)[0]
    except InputError:
        return False
    return first.is_file() and (pictures is None or first.resolve().parent == pictures)
