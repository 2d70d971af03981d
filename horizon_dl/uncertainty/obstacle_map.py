"""From a map of uncertainty to a map of obstacles."""

import numpy as np
from numpy.typing import NDArray


def obstacle_map(score: NDArray[np.floating], threshold: float) -> NDArray[np.bool_]:
    """Pixels over the threshold, without those that stand alone.

    Args:
        score: (h, w) uncertainty; NaN is no obstacle.
        threshold: in the unit of the score; a pixel must exceed it.

    Returns:
        (h, w) bool; a pixel with no obstacle among its 8 neighbours is removed.
    """
    return without_lone_pixels(score > threshold)


def without_lone_pixels(obstacle: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Removes obstacle pixels with fewer than one obstacle neighbour of 8; beyond the border is none."""
    height, width = obstacle.shape
    padded = np.pad(obstacle, 1)
    neighbour = np.zeros_like(obstacle)
    for row in range(3):
        for column in range(3):
            if (row, column) != (1, 1):
                neighbour |= padded[row : row + height, column : column + width]
    return obstacle & neighbour
