"""Targets that also follow what another net was taught."""

import numpy as np
from numpy.typing import NDArray

Map = NDArray[np.float32]


def taught_target(target: Map, elevation: Map, p_obstacle: Map, share: float) -> Map:
    """The weighted mean, below the horizon, of a target and half of what a teacher says; above it the target.

    Half, as a target below the horizon reaches from 0, surely floor, to 0.5, an obstacle: that looks like
    what is seen on both sides (a soft label, Hinton et al. 2015, arXiv:1503.02531).

    Args:
        target: (h, w) in [0, 1], NaN where nothing is known.
        elevation: (h, w) rad.
        p_obstacle: (h, w) in [0, 1], 0 where the teacher is sure of the floor.
        share: the teacher's, in [0, 1].

    Example:
        >>> below = np.full((1, 2), -0.1)
        >>> taught_target(np.array([[0.1, 0.5]]), below, np.array([[1.0, 0.0]]), 0.5).tolist()
        [[0.3, 0.25]]
    """
    mixed = (1.0 - share) * target + share * 0.5 * p_obstacle
    return np.where(elevation <= 0.0, mixed, target)
