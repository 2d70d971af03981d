"""The enhanced unified camera model (Khomutenko, Garcia, Martinet, RA-L 2016), Kalibr's and Basalt's `eucm`.

With beta = 1 it is the unified model as Basalt writes it (`ucm`).
"""

import numpy as np

from horizon_dl.geometry.lenses.lens import Floats, Lens, Mask, Values, divided, with_depth


def project(points: Floats, values: Values) -> Floats:
    """Image points (N, 2); NaN outside of what the model sees."""
    alpha, beta = values
    z = points[:, 2]
    distance = np.sqrt(beta * np.square(points[:, :2]).sum(axis=-1) + z * z)
    w = alpha / (1 - alpha) if alpha <= 0.5 else (1 - alpha) / alpha
    return divided(points[:, :2], alpha * distance + (1 - alpha) * z, z > -w * distance)


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Rays (N, 3) and where they exist."""
    alpha, beta = values
    r2 = np.square(image).sum(axis=-1)
    under_root = 1 - (2 * alpha - 1) * beta * r2
    lower = alpha * np.sqrt(np.maximum(under_root, 0.0)) + 1 - alpha
    return with_depth(image, (1 - beta * alpha * alpha * r2) / np.maximum(lower, 1e-300)), under_root >= 0


LENS = Lens({"alpha": (0.0, 1.0), "beta": (1e-6, 100.0)}, 2, project, unproject)
