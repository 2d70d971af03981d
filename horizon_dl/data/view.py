"""A frame at the learner's size: the image and the elevation of its pixels."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.resize import area_resize


@dataclass(frozen=True)
class View:
    """What a learner sees of a frame.

    Attributes:
        name: the frame's name.
        time_s: seconds, the recording's epoch.
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) float32, rad over the horizon; NaN where the ray is not valid.
    """

    name: str
    time_s: float
    image: NDArray[np.uint8]
    elevation: NDArray[np.float32]


def working_size(camera: Camera, max_pixels: int) -> tuple[int, int]:
    """Width and height of at most `max_pixels` pixels with the camera's aspect; never enlarged.

    Example:
        >>> working_size(Camera("pinhole", 640, 480, 500.0, 500.0, 319.5, 239.5), 76800)
        (320, 240)
    """
    scale = min(1.0, math.sqrt(max_pixels / (camera.width * camera.height)))
    # The small addend keeps a size that is exact but for rounding.
    return max(1, int(camera.width * scale + 1e-6)), max(1, int(camera.height * scale + 1e-6))


def make_view(frame: Frame, max_pixels: int) -> View:
    """The frame at the working size: image by area averaging, elevation from the scaled camera's rays.

    Raises:
        FrameError: the frame has no attitude.
    """
    from horizon_dl.geometry.rays import camera_rays

    if frame.up_cam is None:
        raise FrameError(frame.name, "has no attitude at its time", "leave it out or give its attitude")
    size = working_size(frame.camera, max_pixels)
    image = frame.image
    if size != (frame.camera.width, frame.camera.height):
        image = area_resize(image, size)
    rays = camera_rays(frame.camera.scaled(*size))
    return View(frame.name, frame.time_s, image, elevation(rays.directions, frame.up_cam))
