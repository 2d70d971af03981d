"""The field-of-view model (Devernay and Faugeras 2001): `fov` of Kalibr, `FOV` of COLMAP."""

import math

import numpy as np

from horizon_dl.geometry.lenses.lens import Floats, Lens, Mask, Values, divided, with_depth


def project(points: Floats, values: Values) -> Floats:
    """Image points (N, 2); NaN for points that are not in front."""
    (omega,) = values
    plane = divided(points[:, :2], points[:, 2], points[:, 2] > 0)
    radius = np.linalg.norm(plane, axis=-1)
    near = radius < 1e-12
    bent = np.arctan(2 * radius * math.tan(omega / 2)) / omega
    scale = np.where(near, 2 * math.tan(omega / 2) / omega, bent / np.where(near, 1.0, radius))
    return np.asarray(plane * scale[:, None])


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Rays (N, 3) and where they exist."""
    (omega,) = values
    radius = np.linalg.norm(image, axis=-1)
    seen = radius * omega < math.pi / 2 - 1e-6
    near = radius < 1e-12
    plane = np.tan(np.where(seen, radius * omega, 0.0)) / (2 * math.tan(omega / 2))
    scale = np.where(near, omega / (2 * math.tan(omega / 2)), plane / np.where(near, 1.0, radius))
    return with_depth(image * scale[:, None], 1.0), seen


LENS = Lens({"omega": (1e-3, 3.1)}, 1, project, unproject)
