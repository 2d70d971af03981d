"""How one picture looks in ten numbers, to be compared with those of the training pictures."""

import math

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.horizon_skill import horizon_accuracy
from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.sketch import luma
from horizon_dl.uncertainty.measures import binary_entropy

FEATURES = (
    "level",
    "contrast",
    "fine",
    "coarse",
    "red_green",
    "blue_green",
    "red_green_sd",
    "blue_green_sd",
    "horizon_accuracy",
    "below_entropy",
)
LEAST_RANGE = (20.0, 10.0, 0.5, 0.5, 8.0, 8.0, 8.0, 8.0, 0.05, 0.1)
"""A training set that varies less in a feature is taken to vary by so much."""
BLOCK_PX = 5


def appearance(
    image: NDArray[np.uint8],
    elevation: NDArray[np.floating],
    p_above: NDArray[np.floating],
    limits: EvidenceLimits = LIMITS,
) -> NDArray[np.float64]:
    """(10,) values of `FEATURES`.

    Args:
        image: (h, w, 3) uint8 RGB at the working size.
        elevation: (h, w) rad over the horizon, NaN where not valid.
        p_above: (h, w) of the net.
        limits: band around the horizon.

    Returns:
        Mean and standard deviation of the brightness, grey levels; log2 of its change from pixel to pixel
        and from block to block; mean and standard deviation of red and blue less green; the net's horizon
        accuracy (NaN without a horizon in view) and its mean entropy below it, bits.
    """
    grey = luma(image)
    channels = image[::2, ::2].astype(np.float32)
    red, blue = channels[..., 0] - channels[..., 1], channels[..., 2] - channels[..., 1]
    below = elevation < -limits.band_rad
    return np.array(
        [
            grey.mean(),
            grey.std(),
            _log_change(grey[::2]),
            _log_change(block_means(grey)),
            red.mean(),
            blue.mean(),
            red.std(),
            blue.std(),
            horizon_accuracy(p_above, elevation, limits),
            binary_entropy(p_above[below]).mean() if below.any() else math.nan,
        ],
        np.float64,
    )


def block_means(grey: NDArray[np.float32], size: int = BLOCK_PX) -> NDArray[np.float32]:
    """Means of whole blocks: what a sensor's noise leaves little of."""
    height, width = grey.shape[0] // size * size, grey.shape[1] // size * size
    if not height or not width:
        return grey
    blocks = grey[:height, :width].reshape(height // size, size, width // size, size)
    return np.asarray(blocks.mean(axis=(1, 3)), np.float32)


def _log_change(grey: NDArray[np.float32]) -> float:
    across = np.abs(np.diff(grey, axis=1))
    return math.log2(0.25 + float(across.mean())) if across.size else -2.0
