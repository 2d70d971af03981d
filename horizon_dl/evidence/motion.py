"""Does the picture turn as the attitude says? On small grey sketches, so that it costs next to nothing."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.evidence.sketch import Sketch, difference
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import camera_rays, project

WORSE_FACTOR = 1.5
"""A turn is not believed where the picture that it predicts fits this much worse than the old one does."""
LEAST_OVERLAP = 0.2


def turn_rad(one: ArrayLike, other: ArrayLike) -> float:
    """Angle between two unit vectors, rad; exact for small angles, too.

    Example:
        >>> round(turn_rad([0, -1, 0], [1, 0, 0]), 3)
        1.571
    """
    a, b = np.asarray(one, np.float64), np.asarray(other, np.float64)
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def contradicts(
    camera: Camera, before: Sketch, now: Sketch, up_before: NDArray[np.float64], up_now: NDArray[np.float64]
) -> bool:
    """Whether the attitude turned and the picture stayed.

    Heading and travel move the picture, too, and are not known; they spoil both comparisons alike. So only
    this direction is judged: a picture that moves while the attitude rests proves nothing.

    Args:
        camera: of the frames.
        before: sketch of the earlier frame.
        now: of the later one.
        up_before: (3,) unit, the world's up in the optical frame at the earlier one.
        up_now: at the later one.
    """
    if before.shape != now.shape:
        return False
    turned = turned_sketch(camera, before, tilt_between(up_before, up_now))
    known = ~np.isnan(turned)
    if known.mean() < LEAST_OVERLAP:  # a picture that turned out of view shares nothing with the new one
        known, turned = np.ones_like(known), np.full_like(turned, now.mean())
    as_predicted = difference(turned[known], now[known])
    return as_predicted > WORSE_FACTOR * difference(before[known], now[known])


def tilt_between(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """The shortest rotation (3, 3) that turns the unit vector `one` into `other` (Rodrigues' formula)."""
    x, y, z = np.cross(one, other)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    tilt: NDArray[np.float64] = np.eye(3) + skew + skew @ skew / max(1.0 + float(one @ other), 1e-9)
    return tilt


def turned_sketch(camera: Camera, sketch: Sketch, turn: NDArray[np.float64]) -> NDArray[np.float32]:
    """The sketch (h, w) after the world turned by `turn` in the optical frame; NaN where nothing was seen."""
    height, width = sketch.shape
    small = camera.scaled(width, height)
    # Row vectors: `directions @ turn` turns back, to where each ray of the new picture was in the old one.
    pixels = project(small, camera_rays(small).directions.reshape(-1, 3).astype(np.float64) @ turn)
    with np.errstate(invalid="ignore"):
        column, row = np.nan_to_num(np.rint(pixels), nan=-1.0).clip(-1, 1e6).astype(int).T
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    turned = np.full(height * width, np.nan, np.float32)
    turned[inside] = sketch[row[inside], column[inside]]
    return turned.reshape(height, width)
