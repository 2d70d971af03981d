"""The plain horizon label as a target."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.horizon import IGNORED, horizon_label


def hard_target(
    image: NDArray[np.uint8], elevation: NDArray[np.float32], band_rad: float = 0.0
) -> NDArray[np.float32]:
    """1 above the horizon, 0 below it, whatever the image shows.

    Args:
        image: (h, w, 3) uint8 RGB; not looked at, there so that all targets are called alike.
        elevation: (h, w) rad, NaN where the ray is not valid.
        band_rad: half width of the band around the horizon that is left out, rad.

    Returns:
        (h, w) float32 of 0 and 1, NaN in the band and where the elevation is NaN.
    """
    label = horizon_label(elevation, band_rad)
    return np.where(label == IGNORED, np.nan, label).astype(np.float32)
