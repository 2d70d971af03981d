"""The double sphere (Usenko, Demmel, Cremers: The Double Sphere Camera Model, 3DV 2018), Kalibr's `ds`."""

import math

import numpy as np

from horizon_dl.geometry.lenses.lens import Floats, Lens, Mask, Values, divided, with_depth


def project(points: Floats, values: Values) -> Floats:
    """Image points (N, 2); NaN outside of the half space that the model sees (their equations 40 to 45)."""
    xi, alpha = values
    z = points[:, 2]
    first = np.linalg.norm(points, axis=-1)
    shifted = xi * first + z
    second = np.sqrt(np.square(points[:, :2]).sum(axis=-1) + shifted * shifted)
    w1 = alpha / (1 - alpha) if alpha <= 0.5 else (1 - alpha) / alpha
    w2 = (w1 + xi) / math.sqrt(max(2 * w1 * xi + xi * xi + 1, 1e-12))
    return divided(points[:, :2], alpha * second + (1 - alpha) * shifted, z > -w2 * first)


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Rays (N, 3) and where they exist (their equations 46 to 51)."""
    xi, alpha = values
    r2 = np.square(image).sum(axis=-1)
    under_root = 1 - (2 * alpha - 1) * r2
    m = (1 - alpha * alpha * r2) / (alpha * np.sqrt(np.maximum(under_root, 0.0)) + 1 - alpha)
    second_root = m * m + (1 - xi * xi) * r2
    scale = (m * xi + np.sqrt(np.maximum(second_root, 0.0))) / np.maximum(m * m + r2, 1e-300)
    rays = with_depth(image * scale[:, None], m * scale - xi)
    return rays, (under_root >= 0) & (second_root >= 0)


LENS = Lens({"xi": (-1.0, 5.0), "alpha": (0.0, 1.0)}, 2, project, unproject)
