"""The pinhole: no lens at all."""

import numpy as np

from horizon_dl.geometry.lenses.lens import Floats, Lens, Mask, Values, divided, with_depth


def project(points: Floats, values: Values) -> Floats:
    """`(x, y) / z`; NaN for points that are not in front."""
    return divided(points[:, :2], points[:, 2], points[:, 2] > 0)


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Every image point has its ray."""
    return with_depth(image, 1.0), np.ones(len(image), np.bool_)


LENS = Lens({}, 0, project, unproject)
