"""When the pictures of a folder were taken, by a list of as many times: `timestamps.txt` in or beside it."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.given import Given
from horizon_dl.data.regular_file import files_in
from horizon_dl.data.tables.attitude_columns import read_times
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.table import COMMENTS, Table, number, read_table
from horizon_dl.data.tables.text import read_lines
from horizon_dl.data.tables.units import CAMERA_STEPS
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

LEAST_UNIX_DIGITS = 9
"""Shorter whole numbers that grow by one may be numbers of pictures."""
NAME = re.compile(r"(?:(.*)[_-])?(?:time_?stamps?|times|stamps)\.(?:txt|csv|tsv)")
"""Names of lists; what stands before is the name of their folder of pictures."""


def listed_times(pictures: Path, count: int, given: Given) -> tuple[Floats, tuple[str, ...]] | None:
    """Times (N,) s of a folder's pictures, in the order of their names, and notes; None: there is no list.

    Raises:
        InputError: several lists; or one that has not as many lines as there are pictures, or no times that
            grow.
    """
    lists = _beside(pictures)
    if not lists:
        return None
    if len(lists) > 1:
        names = ", ".join(path.name for path in lists)
        raise InputError(pictures, f"has several lists of times: {names}", "leave one of them there")
    table = _table(lists[0])
    if len(table.rows) != count:
        problem = f"has {len(table.rows)} lines for {count} pictures"
        raise InputError(table.path, problem, "give a line for each, or a table of image and time_s")
    times_s, notes = read_times(table, find_columns(table), given, CAMERA_STEPS)
    if not (np.diff(times_s) > 0).all():
        raise InputError(table.path, "holds no times that grow", "give a time for each picture")
    return times_s, notes


def _beside(pictures: Path) -> list[Path]:
    """Files in the folder, or else beside it."""
    pictures = pictures.resolve()
    for folder in (pictures, pictures.parent):
        found = [path for path in files_in(folder) if _is_of(path, pictures)]
        if found:
            return found
    return []


def _is_of(path: Path, pictures: Path) -> bool:
    found = NAME.fullmatch(path.name.lower())
    return found is not None and found[1] in (None, pictures.resolve().name.lower())


def _table(path: Path) -> Table:
    """The list with names for its columns: its own, or those of lines `time` and `number time`."""
    lines = [line.strip(" \t,;") for line in read_lines(path)]
    bare = [line for line in lines if not line.startswith(COMMENTS)]
    if not bare:
        raise InputError(path, "holds no times", "give a line for each picture")
    if not re.match(r"[-+.\d]", bare[0]):
        return read_table(path)
    if re.search(r"\d:\d", bare[0]):  # dates and times of day have blanks in them
        return Table(path, ("time",), tuple((line,) for line in bare))
    if all(re.fullmatch(r"\d+,\d{1,3}", line) for line in bare):
        problem = "may have decimal commas, or two columns"
        raise InputError(path, problem, "write decimal points, or name the columns, the times time_s")
    rows = [re.split(r"[,;\s]+", line) for line in bare]
    place = 1 if min(map(len, rows)) > 1 and _counts([row[0] for row in rows]) else 0
    if place == 0 and max(map(len, rows)) > 1:
        raise InputError(path, "has several columns without names", "name them, the times time_s")
    column = [row[place] for row in rows]
    if all(cell.isdigit() and len(cell) < LEAST_UNIX_DIGITS for cell in column) and _counts(column):
        raise InputError(path, "counts, which tells no times", "name the column time_s if it is seconds")
    return Table(path, ("time",), tuple((row[place],) for row in rows))


def _counts(cells: list[str]) -> bool:
    try:
        return bool((np.diff([number(cell) for cell in cells]) == 1).all())
    except ValueError:
        return False
