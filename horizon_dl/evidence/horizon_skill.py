"""Is the net right about the horizon of this very picture? The label is free in flight, too."""

import math

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits


def sees_both_sides(elevation: NDArray[np.floating], limits: EvidenceLimits = LIMITS) -> bool:
    """Whether there is enough above and below the horizon to judge by, of `elevation` (h, w) rad."""
    least = limits.least_sky * elevation.size
    above, below = elevation > limits.band_rad, elevation < -limits.band_rad
    return bool(above.sum() >= least and below.sum() >= least)


def horizon_accuracy(
    p_above: NDArray[np.floating], elevation: NDArray[np.floating], limits: EvidenceLimits = LIMITS
) -> float:
    """Mean of the shares of pixels told rightly above and below the horizon, outside the band around it.

    Balanced, so that a net which says the same everywhere (and all pictures without content make it say
    that) has 0.5 however much floor is in view.

    Args:
        p_above: (h, w) in [0, 1].
        elevation: (h, w) rad, NaN where not valid.
        limits: the band, and how much of each side must be seen.

    Returns:
        In [0, 1]; NaN where one side is not in view.

    Example:
        >>> rows = np.linspace(0.5, -0.5, 11)[:, None] * np.ones((11, 8))
        >>> horizon_accuracy(np.full((11, 8), 0.1), rows)
        0.5
    """
    if not sees_both_sides(elevation, limits):
        return math.nan
    above, below = elevation > limits.band_rad, elevation < -limits.band_rad
    return float((p_above[above] > 0.5).mean() + (p_above[below] < 0.5).mean()) / 2
