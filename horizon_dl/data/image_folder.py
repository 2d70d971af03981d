"""Recordings whose images are files: headers with paths, read when asked for."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from horizon_dl.data.bit_depth import FULL, used_bits
from horizon_dl.data.convention import Reading
from horizon_dl.data.decoding import MOST_PIXELS, most_pixels
from horizon_dl.data.frame import FrameHeader, RangeImage
from horizon_dl.data.images import load_rgb, load_truth
from horizon_dl.data.orientation import orientation_of_file, upright
from horizon_dl.data.range_files import lies_as, load_metres
from horizon_dl.data.source import Pixels, Recording
from horizon_dl.data.unique_names import unique_names
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import MountRpy
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
        bits: how many of 16 bits the pictures use; see `bit_depth`.
    """

    files: tuple[FrameFiles, ...]
    rotate_quarter_turns_ccw: int = 0
    range_unit: RangeUnit = RangeUnit()
    most_pixels: int = MOST_PIXELS
    bits: int = FULL

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        """See `Loader`."""
        files = self.files[index]
        image = np.ascontiguousarray(
            np.rot90(load_rgb(files.image, self.most_pixels, self.bits), self.rotate_quarter_turns_ccw)
        )
        truth = load_truth(files.truth, image.shape[:2]) if with_truth and files.truth else None
        ranges = self._ranges(files, image.shape) if with_truth and files.ranges else None
        return Pixels(image, truth, ranges)

    def _ranges(self, files: FrameFiles, upright_shape: tuple[int, ...]) -> RangeImage | None:
        if files.ranges is None:
            return None
        try:
            metres = load_metres(files.ranges, self.range_unit.metres)
        except FrameError:
            return None
        orientation = orientation_of_file(files.image)
        sideways = (orientation >= 5) != (self.rotate_quarter_turns_ccw % 2 == 1)
        stored_shape = upright_shape[1::-1] if sideways else upright_shape[:2]
        if lies_as(metres.shape, stored_shape):
            metres = np.rot90(upright(metres, orientation), self.rotate_quarter_turns_ccw)
        return RangeImage(np.ascontiguousarray(metres), self.range_unit.along)


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
    reading: Reading | None = None,
    needs_attitude: bool = True,
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
        reading: see `Recording`.
        needs_attitude: False where the clock is still to be found.

    Raises:
        InputError: no frames, no image on disk, or no attitude at any frame's time, where one is needed.
    """
    ordered = sorted(frames, key=lambda pair: pair[0].time_s)
    if not ordered:
        raise InputError(where, "holds no frames", "check that the images were copied")
    names = unique_names([header.name for header, _ in ordered])
    headers = tuple(
        replace(header, name=name, labelled=files.truth is not None)
        for name, (header, files) in zip(names, ordered, strict=True)
    )
    files = tuple(files for _, files in ordered)
    if not any(one.image.is_file() for one in files):
        problem = f"none of the {len(files)} images is there, as {headers[0].name}"
        raise InputError(where, problem, "copy the images beside it")
    if needs_attitude and all(header.up_cam is None for header in headers):
        problem = f"no frame has an attitude from {attitude_from}"
        raise InputError(where, problem, "check that its values are numbers")
    load, note = image_loader(files, rotate_quarter_turns_ccw, range_unit, most_pixels(camera))
    return Recording(name, format, camera, headers, load, mount_rpy_rad, (*notes, *note), reading=reading)


def image_loader(
    files: tuple[FrameFiles, ...],
    rotate_quarter_turns_ccw: int = 0,
    range_unit: RangeUnit = RangeUnit(),
    most: int = MOST_PIXELS,
) -> tuple[ImageLoader, tuple[str, ...]]:
    """The loader of some files, and a note where their pictures use some of 16 bits only."""
    bits = used_bits([one.image for one in files])
    note = () if bits == FULL else (f"the pictures use {bits} of their 16 bits, and are scaled by that",)
    return ImageLoader(files, rotate_quarter_turns_ccw, range_unit, most, bits), note
