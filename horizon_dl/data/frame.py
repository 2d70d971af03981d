"""The one frame: an image with its time, and what is known of the camera at that time."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import FrameError
from horizon_dl.geometry.camera import Camera

Vector = NDArray[np.float64]


class Truth(IntEnum):
    """Values of a truth image; it scores, nothing trains on it."""

    IGNORE = 0
    FLOOR = 1
    OBSTACLE = 2
    ABOVE = 3  # ceiling or sky


@dataclass(frozen=True)
class RangeImage:
    """Distances that a depth camera or a lidar measured, upright, at a size of their own.

    Attributes:
        metres: (h, w) float32, NaN where nothing was measured.
        along: `axis`: depth along the optical axis; `ray`: distance from the camera.
    """

    metres: NDArray[np.float32]
    along: Literal["axis", "ray"]


@dataclass(frozen=True)
class FrameHeader:
    """What is known of a frame before its image is read; what is not known is None.

    Attributes:
        name: unique within its source.
        time_s: seconds, any epoch; one clock within a source.
        up_cam: (3,) the world's up as a unit vector in the optical frame (x right, y down, z forward).
        yaw_rad: heading of the body, clockwise seen from above; only differences within a source count.
        height_m: metres of the camera over the floor.
        floor_up_cam: (3,) the floor's normal in the optical frame where it is known to differ from `up_cam`
            (a car stands on its road, however the road tilts); None: the floor is level.
        labelled: the frame has a truth image.
        as_read: the attitude's numbers as they stand in the file: roll, pitch, yaw, or a quaternion.
    """

    name: str
    time_s: float
    up_cam: Vector | None = None
    yaw_rad: float | None = None
    height_m: float | None = None
    floor_up_cam: Vector | None = None
    labelled: bool = False
    as_read: tuple[float, ...] | None = None

    @property
    def floor_normal(self) -> Vector | None:
        """(3,) the floor's normal in the optical frame: the known one, else the world's up."""
        return self.up_cam if self.floor_up_cam is None else self.floor_up_cam


@dataclass(frozen=True, kw_only=True)
class Frame(FrameHeader):
    """A frame with its image.

    Attributes:
        image: (H, W, 3) uint8 RGB, upright.
        camera: intrinsics of the upright image, or None (a plain picture).
        truth: (H, W) uint8 of `Truth`, or None.
        ranges: measured distances, or None.

    Example:
        >>> frame = Frame("a", 0.0, image=np.zeros((2, 3, 3), np.uint8))
        >>> frame.up_cam is None and frame.camera is None
        True
    """

    image: NDArray[np.uint8]
    camera: Camera | None = None
    truth: NDArray[np.uint8] | None = None
    ranges: RangeImage | None = None

    @property
    def calibrated(self) -> Camera:
        """The camera; FrameError where it is not known."""
        if self.camera is None:
            raise FrameError(self.name, "has no known camera", "name its calibration with --camera")
        return self.camera


def fits_camera(frame: Frame) -> bool:
    """Whether the image has the size that its camera, if known, was calibrated for."""
    camera = frame.camera
    return camera is None or frame.image.shape[:2] == (camera.height, camera.width)


def has_attitude(frame: Frame) -> bool:
    """Whether `up_cam` is a direction: three finite numbers of length one, to 1 %."""
    if frame.up_cam is None or not np.isfinite(frame.up_cam).all():
        return False
    return bool(abs(np.linalg.norm(frame.up_cam) - 1.0) < 0.01)


def checked(frame: Frame) -> Frame:
    """The frame; FrameError where its image has another size than its camera."""
    if not fits_camera(frame):
        camera, (height, width) = frame.calibrated, frame.image.shape[:2]
        raise FrameError(
            frame.name,
            f"is {width}x{height} pixels when upright, the camera {camera.width}x{camera.height}",
            "use the image size that the camera was calibrated for",
        )
    return frame
