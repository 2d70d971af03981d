"""Dates in place of numbers."""

import math
import re
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

CLOCK = r"(\d{1,3}):(\d{2}):(\d{2}(?:[.,]\d*)?)"
HALF_A_DAY_S = 43200.0


def seconds_of_dates(cells: Sequence[str]) -> NDArray[np.float64] | None:
    """Unix time (N,) s of dates as `2024-05-01 12:30:00.25`, NaN for blank cells; None where they are none.

    Times of day, or since the start, as `12:30:00.25` are seconds, and go on past midnight.

    A date without a time zone is taken as UTC: only differences count.

    Example:
        >>> seconds_of_dates(["1970-01-01 00:01:00.5", "1970-01-01T00:02:00Z"]).tolist()
        [60.5, 120.0]
    """
    first = next(filter(None, cells), "")
    if re.fullmatch(CLOCK, first):
        return _seconds_of_clock(cells)
    if not re.match(r"\d{4}[-/:]\d{1,2}[-/:]\d{1,2}[ T_]", first):
        return None
    try:
        return np.array([_seconds(cell) if cell else math.nan for cell in cells])
    except ValueError:
        return None


def _seconds(cell: str) -> float:
    date, clock = re.split(r"[ T_]+", cell.removesuffix(" UTC"), maxsplit=1)
    whole = datetime.fromisoformat(f"{re.sub('[/:]', '-', date)}T{clock.replace(',', '.')}")
    return (whole if whole.tzinfo else whole.replace(tzinfo=UTC)).timestamp()


def _seconds_of_clock(cells: Sequence[str]) -> NDArray[np.float64] | None:
    found = [re.fullmatch(CLOCK, cell) for cell in cells]
    if not all(one or not cell for one, cell in zip(found, cells, strict=True)):
        return None
    seconds, days, before = [], 0.0, -math.inf
    for one in found:
        now = math.nan
        if one is not None:
            now = days + 3600.0 * int(one[1]) + 60.0 * int(one[2]) + float(one[3].replace(",", "."))
            if now < before - HALF_A_DAY_S:
                days, now = days + 2 * HALF_A_DAY_S, now + 2 * HALF_A_DAY_S
            before = now
        seconds.append(now)
    return np.array(seconds)
