"""Kannala and Brandt's fisheye (2006), as OpenCV's fisheye and ROS's `equidistant`: radius over angle."""

import numpy as np

from horizon_dl.geometry.lenses.inverse import first_turn, invert_odd_polynomial, odd_polynomial
from horizon_dl.geometry.lenses.lens import FREE, Floats, Lens, Mask, Values, with_depth

MAX_ANGLE_RAD = np.pi


def project(points: Floats, values: Values) -> Floats:
    """Image points (N, 2), also of points behind the camera; NaN beyond the angle where the lens folds."""
    across = np.linalg.norm(points[:, :2], axis=-1)
    angle = np.arctan2(across, points[:, 2])
    profile = odd_polynomial(values)
    radius = np.where(angle <= first_turn(profile.deriv(), MAX_ANGLE_RAD), profile(angle), np.nan)
    # On the axis radius over distance is 1 / z.
    near = across <= 1e-12
    scale = radius / np.where(near, 1.0, across)
    scale = np.where(near, np.where(points[:, 2] > 0, 1.0 / np.maximum(points[:, 2], 1e-300), np.nan), scale)
    return np.asarray(points[:, :2] * scale[:, None])


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Unit rays (N, 3), also beyond 90 degrees off the axis, and where they exist."""
    radius = np.linalg.norm(image, axis=-1)
    angle, found, _ = invert_odd_polynomial(values, radius, MAX_ANGLE_RAD)
    sine_over_radius = np.where(radius > 1e-12, np.sin(angle) / np.maximum(radius, 1e-12), 1.0)
    return with_depth(image * sine_over_radius[:, None], np.cos(angle)), found


LENS = Lens(dict.fromkeys(("k1", "k2", "k3", "k4"), FREE), 0, project, unproject)
