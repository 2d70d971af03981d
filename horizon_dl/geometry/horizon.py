"""Elevation of every pixel over the horizon, and the label that follows from it."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

ABOVE, BELOW, IGNORED = 1, 0, 255


def elevation(directions: NDArray[np.float32], up_cam: ArrayLike) -> NDArray[np.float32]:
    """Angle of each ray over the horizon: `asin(ray . up_cam)`, exact for any lens.

    Args:
        directions: (h, w, 3) unit rays, optical frame (x right, y down, z forward).
        up_cam: (3,) the world's up as a unit vector in the optical frame.

    Returns:
        (h, w) rad in [-pi/2, pi/2]; positive above the horizon; NaN where the ray is NaN.
    """
    sine = directions @ np.asarray(up_cam, dtype=np.float32)
    np.clip(sine, -1.0, 1.0, out=sine)
    result: NDArray[np.float32] = np.arcsin(sine, out=sine)
    return result


def horizon_label(elevation: NDArray[np.floating], band_rad: float = 0.0) -> NDArray[np.uint8]:
    """Label of every pixel: 1 above, 0 below, 255 where it is not used.

    Args:
        elevation: (h, w) rad.
        band_rad: half width of the ignored band around the horizon, rad; covers the error of the attitude.

    Returns:
        (h, w): 1 iff elevation > 0, 255 iff |elevation| < band_rad or elevation is NaN.

    Example:
        >>> horizon_label(np.array([[0.2, 0.01, -0.3]]), band_rad=0.05).tolist()
        [[1, 255, 0]]
    """
    label = np.where(elevation > 0, np.uint8(ABOVE), np.uint8(BELOW))
    label[~(np.abs(elevation) >= band_rad)] = IGNORED
    return label


def labelled_pixels(elevation: NDArray[np.floating], band_rad: float) -> NDArray[np.bool_]:
    """(h, w) bool: the pixels that are learned from, outside the ignored band and with a known elevation."""
    used: NDArray[np.bool_] = horizon_label(elevation, band_rad) != IGNORED
    return used
