"""Frames and recordings: what every reader gives."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.camera import Camera


class Truth(IntEnum):
    """Values of a truth image; it scores, nothing trains on it."""

    IGNORE = 0
    FLOOR = 1
    OBSTACLE = 2
    ABOVE = 3  # ceiling or sky


@dataclass(frozen=True)
class RangeUnit:
    """What the numbers in a range image mean; 0 and the largest uint16 mean that there is none.

    Attributes:
        metres: of one count.
        along: `axis`: depth along the optical axis; `ray`: distance from the camera.
    """

    metres: float
    along: Literal["axis", "ray"]


@dataclass(frozen=True)
class Frame:
    """One image with what is known of its camera at that time.

    Attributes:
        name: unique within its recording, the image's path relative to the recording's folder.
        time_s: seconds, any epoch.
        image: (H, W, 3) uint8 RGB, upright.
        camera: intrinsics for that image size.
        up_cam: (3,) the world's up as a unit vector in the optical frame (x right, y down, z forward), or
            None where the attitude is missing.
        height_m: metres of the camera over the floor, or None.
        truth: (H, W) uint8 of `Truth`, or None.
        floor_up_cam: (3,) the floor's normal in the optical frame where it is known to differ from `up_cam`
            (a car stands on its road, however the road tilts); None: the floor is level.
    """

    name: str
    time_s: float
    image: NDArray[np.uint8]
    camera: Camera
    up_cam: NDArray[np.float64] | None
    height_m: float | None = None
    truth: NDArray[np.uint8] | None = None
    floor_up_cam: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class FrameEntry:
    """What a reader knows of a frame before its image is read."""

    name: str
    time_s: float
    image_path: Path
    up_cam: NDArray[np.float64] | None
    height_m: float | None = None
    truth_path: Path | None = None
    range_path: Path | None = None
    range_unit: RangeUnit = RangeUnit(0.001, "axis")
    floor_up_cam: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Recording:
    """A set of frames in time order, read lazily: only entries are held in memory.

    Attributes:
        name: name of the set.
        format: name of the reader.
        camera: intrinsics of the upright images.
        entries: sorted by time.
        rotate_quarter_turns_ccw: how the stored image is turned to be upright.
        notes: what the reader did that its user should know, a sentence each.
    """

    name: str
    format: str
    camera: Camera
    entries: Sequence[FrameEntry]
    rotate_quarter_turns_ccw: int = 0
    notes: tuple[str, ...] = ()
