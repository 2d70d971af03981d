"""Damage on the way from the sensor: a lost colour, rows of two frames, a picture torn between two rows."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.reason import Reason
from horizon_dl.evidence.sketch import luma

Floats = NDArray[np.float32]

COMB = 1.3
"""Rows differ less from the next than from the one after it; where this much more, they are of two frames."""
LEAST_CHANGE = 2.0
"""Grey levels; less is no structure to judge by."""
LEAST_SHIFT, LARGEST_SHIFT = 3, 5
"""A torn picture goes on shifted by 3 pixels to a fifth of its width."""
TORN_OUTLIER = 1.8
"""A tear is worse than the rows around it by this factor; a straight edge along a row may be, too."""
TORN_FIT = 0.7
"""But only a tear is undone by a shift: the shifted rows fit better by this factor."""
TORN_REST = 1.5
"""And what is left is hardly more than the rows around differ."""
SUSPECTS = 3


def damage(image: NDArray[np.uint8], limits: EvidenceLimits = LIMITS) -> Reason | None:
    """What is wrong with an (H, W, 3) uint8 RGB picture as it came, before any resizing."""
    if channel_is_lost(image, limits):
        return Reason.CHANNEL
    grey = luma(image[:, :: max(1, image.shape[1] // 320)])
    return Reason.TORN if is_combed(grey) or is_torn(grey) else None


def channel_is_lost(image: NDArray[np.uint8], limits: EvidenceLimits = LIMITS) -> bool:
    """Whether one colour says nothing while another says much."""
    spread = image[::4, ::4].reshape(-1, 3).std(axis=0)
    return bool(spread.min() < limits.lost_channel_sd and spread.max() > 10 * limits.lost_channel_sd)


def is_combed(grey: Floats) -> bool:
    """Whether every other row of an (H, w) picture is of another frame."""
    if len(grey) < 4:
        return False
    next_row = float(np.abs(np.diff(grey, axis=0)).mean())
    every_other = float(np.abs(grey[2:] - grey[:-2]).mean())
    return next_row > COMB * max(every_other, LEAST_CHANGE)


def is_torn(grey: Floats) -> bool:
    """Whether a (H, w) picture goes on shifted from some row on.

    The rows that differ most from the ones before are looked at: if shifting the one before makes it fit as
    well as rows do elsewhere, the picture was torn there. An edge of the scene along a row is not undone by
    any shift.
    """
    change = np.abs(np.diff(grey, axis=0)).mean(axis=1)
    if len(change) < 16:
        return False
    return any(_undone(grey, change, row) for row in np.argsort(change)[-SUSPECTS:].tolist())


def _undone(grey: Floats, change: Floats, row: int) -> bool:
    around = np.r_[change[max(0, row - 6) : row], change[row + 1 : row + 7]]
    if change[row] < max(LEAST_CHANGE, TORN_OUTLIER * float(around.max(initial=0.0))):
        return False
    one, other = grey[row], grey[row + 1]
    width = len(one)
    shifts = [s for size in range(LEAST_SHIFT, width // LARGEST_SHIFT) for s in (size, -size)]
    fits = [
        float(np.abs(one[max(0, -s) : width - max(0, s)] - other[max(0, s) : width - max(0, -s)]).mean())
        for s in shifts
    ]
    usual = max(LEAST_CHANGE, TORN_REST * float(around.mean()))
    return bool(fits) and min(fits) < min(usual, TORN_FIT * float(change[row]))
