"""When the pictures of a folder were taken: by the numbers that their names are, or by EXIF."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.photo_tags import exif_time_s

Floats = NDArray[np.float64]

NUMBER = re.compile(r"\d+(?:\.\d+)?")
EPOCH_UNITS = {10: 1.0, 13: 1e-3, 16: 1e-6, 19: 1e-9}
"""Digits before the point of a time since 1970, and its unit in s."""
UNITS = (1.0, 1e-3, 1e-6, 1e-9)
RATES_HZ = (0.2, 500.0)


def picture_times(paths: Sequence[Path]) -> Floats | None:
    """Times (N,) s; None where neither names nor EXIF tell them.

    Names that count (000001, 000002) are numbers of frames and no times.

    Example:
        >>> picture_times([Path("100033333.jpg"), Path("100066666.jpg")]).round(3).tolist()
        [100.033, 100.067]
        >>> picture_times([Path("000001.jpg"), Path("000002.jpg")]) is None
        True
    """
    numbers = [NUMBER.findall(path.stem) for path in paths]
    if all(numbers):
        times_s = _of_numbers([found[-1] for found in numbers])
        if times_s is not None:
            return times_s
    taken = [exif_time_s(path) for path in paths]
    known = [time_s for time_s in taken if time_s is not None]
    return np.array(known) if known and len(known) == len(taken) else None


def _of_numbers(texts: Sequence[str]) -> Floats | None:
    values = np.array([float(text) for text in texts])
    digits = {len(text.split(".")[0]) for text in texts}
    if len(digits) == 1 and (unit := EPOCH_UNITS.get(next(iter(digits)))) and values.min() * unit > 5e8:
        return values * unit
    steps = np.diff(np.sort(values))
    step = float(np.median(steps)) if len(steps) else 0.0
    if step <= 0 or (step <= 10 and not any("." in text for text in texts)):
        return None
    for unit in UNITS:
        if RATES_HZ[0] <= 1.0 / (step * unit) <= RATES_HZ[1]:
            return values * unit
    return None


def by_shutter(times_s: Floats, shutter_s: Floats) -> Floats | None:
    """The log's times of pictures that it triggered, where numbers and pauses agree; else None.

    Args:
        times_s: (N,) by the pictures, sorted, to a second.
        shutter_s: (N,) by the log.
    """
    if len(times_s) != len(shutter_s):
        return None
    apart = (times_s - times_s[0]) - (shutter_s - shutter_s[0])
    return shutter_s if np.ptp(apart) < 2.0 else None
