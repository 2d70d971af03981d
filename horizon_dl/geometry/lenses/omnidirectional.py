"""The unified model with distortion (Mei and Rives, ICRA 2007): Kalibr's `omni`, VINS's `MEI`.

A point goes to the unit sphere, from there to a plane seen from `xi` behind the centre, and is then bent as
by Brown's k1, k2, p1, p2.
"""

import numpy as np

from horizon_dl.geometry.lenses import brown
from horizon_dl.geometry.lenses.lens import FREE, Floats, Lens, Mask, Values, divided, with_depth


def project(points: Floats, values: Values) -> Floats:
    """Image points (N, 2); NaN outside of what the model sees."""
    xi, *bend = values
    sphere = points / np.maximum(np.linalg.norm(points, axis=-1, keepdims=True), 1e-300)
    z = sphere[:, 2]
    plane = divided(sphere[:, :2], z + xi, z > -(1 / xi if xi > 1 else xi))
    inside = np.linalg.norm(plane, axis=-1) <= brown.reach(tuple(bend))
    image, _ = brown.distort(np.where(inside[:, None], plane, 0.0), tuple(bend))
    return np.where(inside[:, None], image, np.nan)


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Rays (N, 3) and where they exist."""
    xi, *bend = values
    plane, found = brown.undistort(image, tuple(bend))
    r2 = np.square(plane).sum(axis=-1)
    under_root = 1 + (1 - xi * xi) * r2
    scale = (xi + np.sqrt(np.maximum(under_root, 0.0))) / (r2 + 1)
    return with_depth(plane * scale[:, None], scale - xi), found & (under_root >= 0)


LENS = Lens({"xi": (0.0, 100.0)} | dict.fromkeys(("k1", "k2", "p1", "p2"), FREE), 1, project, unproject)
