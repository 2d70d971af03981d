"""A frame at the learner's size even where its attitude is missing or its image has another size."""

from dataclasses import replace

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View, make_view, working_size
from horizon_dl.geometry.attitude import unit
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import area_resize


def any_view(seen: View | Frame, max_pixels: int) -> View:
    """The view of a frame; its elevation is NaN all over where it cannot be known."""
    if isinstance(seen, View):
        return seen
    if fits_camera(seen) and has_attitude(seen):
        assert seen.up_cam is not None
        return make_view(replace(seen, up_cam=unit(seen.up_cam)), max_pixels)
    height, width = seen.image.shape[:2]
    size = working_size(Camera("pinhole", width, height, 1.0, 1.0, 0.0, 0.0), max_pixels)
    image = area_resize(seen.image, size)
    return View(seen.name, seen.time_s, image, np.full(image.shape[:2], np.nan, np.float32))


def fits_camera(frame: Frame) -> bool:
    """Whether the image has the size that the camera was calibrated for."""
    return frame.image.shape[:2] == (frame.camera.height, frame.camera.width)


def has_attitude(frame: Frame) -> bool:
    """Whether `up_cam` is a direction: three finite numbers of length one, to 1 %."""
    if frame.up_cam is None or not np.isfinite(frame.up_cam).all():
        return False
    return bool(abs(np.linalg.norm(frame.up_cam) - 1.0) < 0.01)
