"""By how much do the net and the attitude disagree about the horizon? A mount that slipped shows here.

The horizon accuracy hardly falls when an attitude is wrong by 10 degrees: most of a picture stays on its side
of the line. Where the line itself lies tells it.
"""

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.horizon_skill import sees_both_sides
from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.reason import Reason

LINES_RAD = np.radians(np.arange(-20.0, 20.25, 0.5))
"""Elevations of the level lines that are tried."""
PARTS = 16
"""Of the picture, side by side: an obstacle in some of them moves the line there alone."""
SUREST = 0.98
"""A pixel's `p_above` counts as at most so sure: no single one decides."""


def horizon_offset(
    p_above: NDArray[np.floating], elevation: NDArray[np.floating], limits: EvidenceLimits = LIMITS
) -> float:
    """Elevation of the level line that parts best what the net takes for above from what it takes for below.

    Median over the parts of the picture of each one's likeliest line, every pixel taken for itself. One
    degree of freedom, so that it costs a flight little (`geometry.horizon_line.up_from_map` searches roll
    as well).

    Args:
        p_above: (h, w) in [0, 1].
        elevation: (h, w) rad by the attitude, NaN where not valid.
        limits: how much of each side must be seen.

    Returns:
        rad, 0 where both agree, positive where the attitude has the horizon too low; NaN where one side is
        not in view.

    Example:
        >>> rows = np.linspace(0.5, -0.5, 201)[:, None] * np.ones((201, 32))
        >>> p_above = np.where(rows > np.radians(10.0), 0.9, 0.1)
        >>> round(math.degrees(horizon_offset(p_above, rows)), 1)
        10.0
    """
    if not sees_both_sides(elevation, limits):
        return math.nan
    p_above, elevation = p_above[::2, ::2], elevation[::2, ::2]  # tells as much, for a quarter of the time
    known = np.isfinite(elevation)
    p = np.clip(p_above[known], 1 - SUREST, SUREST)
    steps = len(LINES_RAD) + 1
    part = np.broadcast_to(np.arange(elevation.shape[1]) * PARTS // elevation.shape[1], elevation.shape)[
        known
    ]
    cell = part * steps + np.searchsorted(LINES_RAD, elevation[known])
    log_odds = np.bincount(cell, np.log(p / (1 - p)), minlength=PARTS * steps).reshape(PARTS, steps)
    above = np.cumsum(log_odds[:, ::-1], axis=1)[:, ::-1][:, 1:]
    in_view = np.bincount(part, minlength=PARTS) > 0  # a round picture has nothing at its sides
    return float(np.median(LINES_RAD[above[in_view].argmax(axis=1)]))


@dataclass
class OffsetWatch:
    """Compares the offset of the last second with those of the training.

    Attributes:
        limits: see there.
    """

    limits: EvidenceLimits = field(default_factory=lambda: LIMITS)
    _seen: deque[tuple[float, float]] = field(default_factory=deque)

    def problem(
        self, time_s: float, offset_rad: float, usual_rad: tuple[float, float] | None
    ) -> Reason | None:
        """`MOUNT` or None.

        Args:
            time_s: of the picture.
            offset_rad: of `horizon_offset`; NaN says nothing.
            usual_rad: least and greatest of the training pictures; None: not known.
        """
        recent = ((at, offset) for at, offset in self._seen if 0 <= time_s - at <= self.limits.offset_s)
        self._seen = deque(recent)
        if math.isfinite(offset_rad):
            self._seen.append((time_s, offset_rad))
        if usual_rad is None or not self._seen:
            return None
        offset = float(np.median([offset for _, offset in self._seen]))
        margin = self.limits.offset_margin_rad
        usual = usual_rad[0] - margin <= offset <= usual_rad[1] + margin
        return None if usual else Reason.MOUNT
