"""The ray of every pixel, computed once for a camera, and projection of points to pixels.

Every ray is projected again; pixels that do not return to their place are not valid.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.lenses.registry import LENSES

Floats = NDArray[np.float64]

MAX_ERROR_PX = 0.01
"""Largest distance between a pixel and the projection of its ray."""


@dataclass(frozen=True)
class Rays:
    """Rays of all pixels of a camera.

    Attributes:
        directions: (h, w, 3) float32 unit vectors, optical frame; NaN where not valid.
        valid: (h, w) bool, the lens model could be inverted there to within `MAX_ERROR_PX`.
    """

    directions: NDArray[np.float32]
    valid: NDArray[np.bool_]


@lru_cache(maxsize=16)
def camera_rays(camera: Camera) -> Rays:
    """Rays through all pixel centres; computed once for each camera and kept (do not write into them)."""
    u, v = np.meshgrid(np.arange(camera.width, dtype=np.float64), np.arange(camera.height, dtype=np.float64))
    directions, valid = unproject(camera, np.stack([u.ravel(), v.ravel()], axis=-1))
    shape = (camera.height, camera.width)
    rays = Rays(directions.astype(np.float32).reshape(*shape, 3), valid.reshape(shape))
    rays.directions.setflags(write=False)
    rays.valid.setflags(write=False)
    return rays


def unproject(camera: Camera, pixels: ArrayLike) -> tuple[Floats, NDArray[np.bool_]]:
    """Unit rays (N, 3) of pixels (N, 2) in the optical frame and a mask (N,) of those that are valid.

    Rays that are not valid are NaN: no convergence, or beyond the radius where the lens model folds over, so
    that two rays would meet in one pixel.
    """
    points = np.asarray(pixels, dtype=np.float64).reshape(-1, 2)
    image = (points - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    rays, valid = LENSES[camera.model].unproject(image, camera.distortion)
    length = np.linalg.norm(rays, axis=-1, keepdims=True)
    directions = rays / np.where(length > 1e-12, length, np.nan)
    error = np.linalg.norm(project(camera, directions) - points, axis=-1)
    valid = valid & (error < MAX_ERROR_PX)
    directions[~valid] = np.nan
    return directions, valid


def project(camera: Camera, points_cam: ArrayLike) -> Floats:
    """Pixels (N, 2) of points (N, 3) in the optical frame, any unit of length; NaN where the lens sees none.

    Example:
        >>> project(Camera("pinhole", 640, 480, 500.0, 500.0, 319.5, 239.5), [[0.1, 0.0, 1.0]]).tolist()
        [[369.5, 239.5]]
    """
    points = np.asarray(points_cam, dtype=np.float64).reshape(-1, 3)
    image = LENSES[camera.model].project(points, camera.distortion)
    return np.asarray(image * [camera.fx, camera.fy] + [camera.cx, camera.cy])
