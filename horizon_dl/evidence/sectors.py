"""Evidence of a sector: how much of the floor that it claims shows detail, and how much familiar colours."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.sketch import luma
from horizon_dl.geometry.polar import PolarView
from horizon_dl.ranging.sectors import FreeDistances, Outcome

Mask = NDArray[np.bool_]

LOST_PX = 5
"""So many pixels around a lost one do not change either."""


def lost_pixels(image: NDArray[np.uint8], changes: float = 0.2) -> Mask:
    """(h, w) pixels in whose surroundings (5 x 5) brightness hardly changes from pixel to pixel.

    A sensor's noise changes every pixel; what a decoder, a broken line or an overflow fills in does not.

    Args:
        image: (h, w, 3) uint8 RGB.
        changes: mean absolute change, grey levels, that lost ones have at most.
    """
    grey = luma(image)
    change = np.zeros_like(grey)
    change[:, 1:] += np.abs(np.diff(grey, axis=1))
    change[1:] += np.abs(np.diff(grey, axis=0))
    # Saturated pixels show nothing either, whatever the noise of the others.
    return box_mean(np.minimum(change, 2.0), LOST_PX) < 2 * changes


def box_mean(values: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """(h, w) mean of a square around each pixel, of odd size; at the rim of what is there."""
    half = size // 2
    padded = np.pad(values, ((half + 1, half), (half + 1, half)), "edge")
    total = padded.cumsum(axis=0, dtype=np.float64).cumsum(axis=1)
    box = total[size:, size:] - total[:-size, size:] - total[size:, :-size] + total[:-size, :-size]
    return np.asarray(box / size**2, np.float32)


def claimed_share(found: FreeDistances, polar: PolarView, pixels: Mask) -> NDArray[np.float32]:
    """(sectors,) share of the floor that a sector claims, up to its contact, that a mask covers.

    Args:
        found: sectors of the frame.
        polar: the cells they came from.
        pixels: (h, w).

    Returns:
        In [0, 1]; 0 for sectors that claim nothing.
    """
    end_row = np.floor(np.nan_to_num(found.depression_rad) / polar.row_step_rad)
    claimed = np.arange(polar.rows) >= np.maximum(end_row, 0)[:, None]
    claimed &= (found.outcome != Outcome.UNKNOWN)[:, None]
    of = (polar.pixels * claimed).sum(axis=1)
    covered = (polar.counts(pixels) * claimed).sum(axis=1)
    return np.asarray(covered / np.maximum(of, 1), np.float32)


def sectors_without_evidence(
    found: FreeDistances,
    polar: PolarView,
    lost: Mask,
    unfamiliar: Mask | None,
    limits: EvidenceLimits = LIMITS,
) -> tuple[Mask, Mask]:
    """(sectors,) whose floor was lost, and (sectors,) whose floor has colours that were never seen.

    Args:
        found: sectors of the frame.
        polar: the cells they came from.
        lost: (h, w) of `lost_pixels`.
        unfamiliar: (h, w) of `Place.unfamiliar`; None where that is not known.
        limits: shares.
    """
    gone = claimed_share(found, polar, lost) > limits.lost_share
    if unfamiliar is None:
        return gone, np.zeros_like(gone)
    return gone, claimed_share(found, polar, unfamiliar) > limits.strange_share
