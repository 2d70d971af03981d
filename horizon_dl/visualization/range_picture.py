"""Distances and heading drawn into a frame's picture."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.flown import unknown_words
from horizon_dl.visualization.ranges import draw_ranges


def draw_ranged(image: Image, directions: NDArray[np.float32], ranged: Ranged) -> Image:
    """The picture, at the size of the rays, with free, blocked and unknown bearings; see `draw_ranges`."""
    return draw_ranges(
        image,
        directions,
        ranged.up_cam,
        ranged.found,
        ranged.heading,
        forward_cam=ranged.forward_cam,
        far_m=ranged.vehicle.far_m,
        words=unknown_words(ranged),
    )
