"""Dates in place of numbers."""

import math
import re
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray


def seconds_of_dates(cells: Sequence[str]) -> NDArray[np.float64] | None:
    """Unix time (N,) s of dates as `2024-05-01 12:30:00.25`, NaN for blank cells; None where they are none.

    A date without a time zone is taken as UTC: only differences count.

    Example:
        >>> seconds_of_dates(["1970-01-01 00:01:00.5", "1970-01-01T00:02:00Z"]).tolist()
        [60.5, 120.0]
    """
    if not any(cells) or not re.match(r"\d{4}[-/:]\d{1,2}[-/:]\d{1,2}[ T_]", next(filter(None, cells))):
        return None
    try:
        return np.array([_seconds(cell) if cell else math.nan for cell in cells])
    except ValueError:
        return None


def _seconds(cell: str) -> float:
    date, clock = re.split(r"[ T_]+", cell, maxsplit=1)
    whole = datetime.fromisoformat(f"{re.sub('[/:]', '-', date)}T{clock.replace(',', '.')}")
    return (whole if whole.tzinfo else whole.replace(tzinfo=UTC)).timestamp()
