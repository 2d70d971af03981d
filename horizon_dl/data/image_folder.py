"""Recordings whose images are files: headers with paths, read when asked for."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from horizon_dl.data.frame import FrameHeader, RangeImage
from horizon_dl.data.images import MOST_PIXELS, load_rgb, load_truth, load_uint16, most_pixels
from horizon_dl.data.source import MountRpy, Pixels, Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.camera import Camera


@dataclass(frozen=True)
class RangeUnit:
    """What the numbers in a range image mean; 0 and the largest uint16 mean that there is none.

    Attributes:
        metres: of one count.
        along: see `RangeImage`.
    """

    metres: float = 0.001
    along: Literal["axis", "ray"] = "axis"


@dataclass(frozen=True)
class FrameFiles:
    """The files of one frame: its image as stored, and where there are, its upright truth and its ranges."""

    image: Path
    truth: Path | None = None
    ranges: Path | None = None


@dataclass(frozen=True)
class ImageLoader:
    """Reads frames whose images are files.

    Attributes:
        files: of all frames.
        rotate_quarter_turns_ccw: how a stored image is turned to be upright.
        range_unit: of all range images.
        most_pixels: of an image that is decoded.
    """

    files: tuple[FrameFiles, ...]
    rotate_quarter_turns_ccw: int = 0
    range_unit: RangeUnit = RangeUnit()
    most_pixels: int = MOST_PIXELS

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        """See `Loader`."""
        files = self.files[index]
        stored = load_rgb(files.image, self.most_pixels)
        image = np.ascontiguousarray(np.rot90(stored, self.rotate_quarter_turns_ccw))
        truth = load_truth(files.truth, image.shape[:2]) if with_truth and files.truth else None
        ranges = self._ranges(files.ranges, stored.shape) if with_truth and files.ranges else None
        return Pixels(image, truth, ranges)

    def _ranges(self, path: Path, stored: tuple[int, ...]) -> RangeImage | None:
        try:
            counts = load_uint16(path)
        except FrameError:
            return None
        if lies_as(counts.shape, stored):
            counts = np.rot90(counts, self.rotate_quarter_turns_ccw)
        none = (counts == 0) | (counts == np.iinfo(np.uint16).max)
        metres = np.where(none, np.nan, counts * np.float32(self.range_unit.metres))
        return RangeImage(metres.astype(np.float32), self.range_unit.along)


def lies_as(shape: tuple[int, ...], stored: tuple[int, ...]) -> bool:
    """Whether a range image lies as its stored image does, and has to be turned with it.

    One that was saved upright, as labels are, betrays itself by its sides after a quarter turn.

    Example:
        >>> lies_as((120, 160), (240, 320)), lies_as((160, 120), (240, 320))
        (True, False)
    """
    return (shape[0] < shape[1]) == (stored[0] < stored[1])


def image_recording(
    name: str,
    format: str,
    camera: Camera | None,
    frames: Iterable[tuple[FrameHeader, FrameFiles]],
    *,
    where: Path,
    attitude_from: str,
    rotate_quarter_turns_ccw: int = 0,
    mount_rpy_rad: MountRpy | None = None,
    range_unit: RangeUnit = RangeUnit(),
    notes: tuple[str, ...] = (),
) -> Recording:
    """A recording of image files, sorted by time.

    Args:
        name: see `Recording`.
        format: see `Recording`.
        camera: see `Recording`.
        frames: headers with their files, in any order.
        where: file or folder that is to be corrected where something is wrong.
        attitude_from: the source of the attitude, in words for the error.
        rotate_quarter_turns_ccw: see `ImageLoader`.
        mount_rpy_rad: see `Recording`.
        range_unit: see `ImageLoader`.
        notes: see `Recording`.

    Raises:
        InputError: no frames, no image on disk, or no attitude at any frame's time.
    """
    ordered = sorted(frames, key=lambda pair: pair[0].time_s)
    if not ordered:
        raise InputError(where, "holds no frames", "check that the images were copied")
    headers = tuple(replace(header, labelled=files.truth is not None) for header, files in ordered)
    files = tuple(files for _, files in ordered)
    if not any(one.image.is_file() for one in files):
        problem = f"none of the {len(files)} images is there, as {headers[0].name}"
        raise InputError(where, problem, "copy the images beside it")
    if all(header.up_cam is None for header in headers):
        problem = f"no frame has an attitude from {attitude_from}"
        raise InputError(where, problem, "check that its values are numbers")
    load = ImageLoader(files, rotate_quarter_turns_ccw, range_unit, most_pixels(camera))
    return Recording(name, format, camera, headers, load, mount_rpy_rad, notes)
