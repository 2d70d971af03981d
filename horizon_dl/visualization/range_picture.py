"""Distances and heading drawn into a frame's picture."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.ranged import Ranged, range_frame
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


def range_picture(
    frame: Frame, directions: NDArray[np.float32], p_above: NDArray[np.float32], threshold: float
) -> Image | None:
    """`range_frame`, drawn: (h, w, 3) uint8 RGB, or None."""
    found = range_frame(frame, directions, p_above, threshold)
    return None if found is None else draw_ranged(frame.image, directions, found)
