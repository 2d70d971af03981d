"""Times of pictures whose names tell none, from a list in or beside their folder."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.given import Given
from horizon_dl.data.listed_times import listed_times
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.table import read_table
from horizon_dl.errors import InputError
from horizon_dl.readers.frames_table import image_lists, listed_images


def times_beside(
    folder: Path, paths: list[Path], given: Given
) -> tuple[list[Path], NDArray[np.float64], tuple[str, ...]] | None:
    """The pictures of a folder that are listed, their times (N,) s, and notes; None: there is no list.

    Args:
        folder: of the pictures.
        paths: of all its pictures, by name.
        given: the times' unit.

    Raises:
        InputError: several lists, or one that does not fit.
    """
    lists = image_lists(folder)
    if len(lists) > 1:
        names = ", ".join(one.name for one in lists)
        raise InputError(folder, f"has several lists of pictures: {names}", "give one of them as DATA")
    if lists:
        table = read_table(lists[0])
        return listed_images(table, find_columns(table), given, folder)
    found = listed_times(folder, len(paths), given)
    return None if found is None else (paths, *found)
