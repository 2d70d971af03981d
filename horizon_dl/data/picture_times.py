"""When the pictures of a folder were taken: by the numbers that their names are, or by EXIF."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.photo_tags import exif_time_s

Floats = NDArray[np.float64]

NUMBER = re.compile(r"\d+(?:\.\d+)?")
DATE = re.compile(
    r"(?<!\d)((?:19|20)\d\d)[-_.]?([01]\d)[-_.]?([0-3]\d)[-_T .]?([0-2]\d)[-_.:h]?([0-5]\d)[-_.:m]?([0-5]\d)"
    r"(?:[-_.,]?(\d{1,9}))?(?!\d)"
)
EPOCH_UNITS = {10: 1.0, 13: 1e-3, 16: 1e-6, 19: 1e-9}
"""Digits before the point of a time since 1970, and its unit in s."""
FRACTIONS = (3, 6, 9)
"""Digits of the part of a second that stands beside whole seconds, as ROS names pictures."""
UNITS = (1.0, 1e-3, 1e-6, 1e-9)
RATES_HZ = (0.2, 500.0)
MOST_SKIPPED = 1000
"""Frames from which one was taken; larger steps are of a clock."""


def picture_times(paths: Sequence[Path]) -> Floats | None:
    """Times (N,) s; None where neither names nor EXIF tell them.

    Names that count (000001, 000002; also 0000, 0030, 0060) are numbers of frames and no times.

    Example:
        >>> picture_times([Path("100033333.jpg"), Path("100066666.jpg")]).round(3).tolist()
        [100.033, 100.067]
        >>> picture_times([Path("000001.jpg"), Path("000002.jpg")]) is None
        True
        >>> picture_times([Path("1970-01-01_00-00-01.250.png"), Path("1970-01-01_00-00-01.500.png")]).tolist()
        [1.25, 1.5]
    """
    stems = [path.stem for path in paths]
    dates = [DATE.search(stem) for stem in stems]
    dated = [date for date in dates if date is not None]
    if len(dated) == len(stems):
        times_s = _of_dates(dated)
    else:
        times_s = _of_numbers([NUMBER.findall(stem) for stem in stems])
    if times_s is not None:
        return times_s
    taken = [exif_time_s(path) for path in paths]
    known = [time_s for time_s in taken if time_s is not None]
    return np.array(known) if known and len(known) == len(taken) else None


def _of_dates(dates: Sequence[re.Match[str]]) -> Floats | None:
    """Unix time of dates with times of day, taken as UTC; None where they are not fine enough."""
    try:
        times_s = [_seconds(date) for date in dates]
    except ValueError:
        return None
    return np.array(times_s) if len(set(times_s)) == len(times_s) else None


def _seconds(found: re.Match[str]) -> float:
    *whole, fraction = found.groups()
    year, month, day, hour, minute, second = map(int, whole)
    seconds = datetime(year, month, day, hour, minute, second, tzinfo=UTC).timestamp()
    return seconds + float(f"0.{fraction or 0}")


def _of_numbers(found: Sequence[Sequence[str]]) -> Floats | None:
    """By the last of the names' numbers that changes, such as 1714570000123 in 1714570000123_cam0."""
    count = len(found[0]) if found else 0
    if not count or any(len(numbers) != count for numbers in found):
        return None
    columns = list(zip(*found, strict=True))
    for seconds, rest in pairwise(columns):
        lengths = {len(text) for text in rest}
        if _is_epoch(seconds) and len(lengths) == 1 and lengths <= set(FRACTIONS):
            return np.array([float(f"{s}.{r}") for s, r in zip(seconds, rest, strict=True)])
    changing = [column for column in columns if len(set(column)) > 1]
    return _of_column(changing[-1] if changing else columns[-1])


def _is_epoch(texts: Sequence[str]) -> bool:
    return all(len(text) == 10 and float(text) > 5e8 for text in texts)


def _of_column(texts: Sequence[str]) -> Floats | None:
    values = np.array([float(text) for text in texts])
    digits = {len(text.split(".")[0]) for text in texts}
    if len(digits) == 1 and (unit := EPOCH_UNITS.get(next(iter(digits)))) and values.min() * unit > 5e8:
        return values * unit
    steps = np.diff(np.sort(values))
    step = float(np.median(steps)) if len(steps) else 0.0
    if step <= 0 or (not any("." in text for text in texts) and _counts(texts, steps)):
        return None
    for unit in UNITS:
        if RATES_HZ[0] <= 1.0 / (step * unit) <= RATES_HZ[1]:
            return values * unit
    return None


def _counts(texts: Sequence[str], steps: Floats) -> bool:
    """Whether whole numbers count frames: by small steps, or every so many of them, with leading zeros."""
    alike = bool((steps == steps[0]).all()) and steps[0] <= MOST_SKIPPED
    return float(np.median(steps)) <= 10 or (alike and any(text.startswith("0") for text in texts))


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
