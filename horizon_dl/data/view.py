"""A frame at the learner's size: the image and the elevation of its pixels."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, checked, fits_camera, has_attitude
from horizon_dl.errors import FrameError
from horizon_dl.geometry.attitude import unit
from horizon_dl.geometry.camera import working_size
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.resize import area_resize


@dataclass(frozen=True)
class View:
    """What a learner sees of a frame.

    Attributes:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) float32, rad over the horizon; NaN where it is not known.
    """

    image: NDArray[np.uint8]
    elevation: NDArray[np.float32]


def make_view(frame: Frame, max_pixels: int) -> View:
    """The frame at the working size: image by area averaging, elevation from the scaled camera's rays.

    Raises:
        FrameError: the frame has no attitude or no camera, or another size than its camera.
    """
    from horizon_dl.geometry.rays import camera_rays

    if frame.up_cam is None:
        raise FrameError(frame.name, "has no attitude at its time", "leave it out or give its attitude")
    image = _reduced(checked(frame), max_pixels)
    rays = camera_rays(frame.calibrated.scaled(image.shape[1], image.shape[0]))
    return View(image, elevation(rays.directions, frame.up_cam))


def any_view(frame: Frame, max_pixels: int) -> View:
    """The view of any frame; its elevation is NaN all over where attitude or camera are not known."""
    if frame.up_cam is not None and frame.camera is not None and fits_camera(frame) and has_attitude(frame):
        return make_view(replace(frame, up_cam=unit(frame.up_cam)), max_pixels)
    image = _reduced(frame, max_pixels)
    return View(image, np.full(image.shape[:2], np.nan, np.float32))


def _reduced(frame: Frame, max_pixels: int) -> NDArray[np.uint8]:
    height, width = frame.image.shape[:2]
    size = working_size(width, height, max_pixels)
    return frame.image if size == (width, height) else area_resize(frame.image, size)
