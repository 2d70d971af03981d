"""When the pictures of a folder were taken, by a list of as many times: `timestamps.txt` in or beside it."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.picture_times import NUMBER, times_of_numbers
from horizon_dl.data.tables.iso_time import seconds_of_dates
from horizon_dl.data.tables.table import COMMENTS
from horizon_dl.data.tables.text import read_lines
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

NAME = re.compile(r"(.*[_-])?(time_?stamps?|times|stamps)\.(txt|csv|tsv)")


def listed_times(folder: Path, count: int) -> Floats | None:
    """Times (N,) s of a folder's pictures, in the order of their names; None: there is no list.

    Raises:
        InputError: it has not as many lines as there are pictures, or they are no times that grow.
    """
    path = _list_of(folder)
    if path is None:
        return None
    lines = [line.strip() for line in read_lines(path) if not line.lstrip().startswith(COMMENTS)]
    if lines and not lines[0][:1].isdigit():  # names of columns
        del lines[0]
    if len(lines) != count:
        problem = f"has {len(lines)} lines for {count} pictures"
        raise InputError(path, problem, "give a line for each, or a table of image and time_s")
    times_s = seconds_of_dates(lines)
    if times_s is None:
        times_s = _of_columns([re.split(r"[,;\s]+", line) for line in lines])
    if times_s is None or not (np.diff(times_s) > 0).all():
        raise InputError(path, "holds no times that grow", "give a time for each picture, or a table")
    return times_s


def _list_of(folder: Path) -> Path | None:
    places = [place for place in (folder, folder.resolve().parent) if place.is_dir()]
    files = (file for place in places for file in sorted(place.iterdir()))
    return next((file for file in files if NAME.fullmatch(file.name.lower()) and file.is_file()), None)


def _of_columns(rows: list[list[str]]) -> Floats | None:
    """The last column of numbers that may be times: what stands before it is a number of the picture."""
    for column in reversed(list(zip(*rows, strict=False))):
        if all(NUMBER.fullmatch(cell) for cell in column):
            times_s = times_of_numbers(column, may_count=False)
            if times_s is not None:
                return times_s
    return None
