"""Where frames come from: recordings, which can be read again, and live sources, which cannot."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.convention import Reading, parse_convention
from horizon_dl.data.frame import Frame, FrameHeader, RangeImage, checked
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import MountRpy
from horizon_dl.geometry.camera import Camera


def calibrated(source: "FrameSource") -> Camera:
    """The camera of a source; InputError for plain pictures, of which no camera is known."""
    if source.camera is None:
        raise InputError(source.name, "has no known camera", "name its calibration with --camera")
    return source.camera


class FrameSource(Protocol):
    """Frames in the order of their time, whatever lies behind them: folders, films, logs, cameras.

    Attributes:
        name: of the data.
        format: name of the reader, or `live`.
        camera: intrinsics of the upright images; None for plain pictures.
        mount_rpy_rad: roll, pitch and yaw of the camera in the body; None where it is not known.
        notes: what the reader did that its user should know, a sentence each.
        length: number of frames, or None where that is not known.
        live: frames come when they come, and do not wait.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def format(self) -> str: ...  # noqa: D102

    @property
    def camera(self) -> Camera | None: ...  # noqa: D102

    @property
    def mount_rpy_rad(self) -> MountRpy | None: ...  # noqa: D102

    @property
    def notes(self) -> tuple[str, ...]: ...  # noqa: D102

    @property
    def length(self) -> int | None: ...  # noqa: D102

    @property
    def live(self) -> bool: ...  # noqa: D102

    def frames(self, start: int = 0) -> Iterator[Frame | FrameError]:
        """Frames from a position on; in place of one whose image cannot be read, the error."""
        ...

    def stop(self) -> None:
        """End `frames` soon, from any thread, even while no frame comes."""
        ...


@dataclass(frozen=True)
class Pixels:
    """What is read of a frame when it is asked for; see `Frame`."""

    image: NDArray[np.uint8]
    truth: NDArray[np.uint8] | None = None
    ranges: RangeImage | None = None


class Loader(Protocol):
    """Reads the images of a recording; it travels between processes."""

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        """The upright image at an index, with truth and ranges if asked for and there.

        Raises:
            FrameError: the image, or a truth that was asked for, cannot be read.
        """
        ...


@dataclass(frozen=True)
class Recording:
    """A finished recording, a `FrameSource` that can be read at any index; images are read when asked for.

    Attributes:
        headers: of all frames, sorted by time.
        load: reads a frame's image.
        reading: how the attitudes were read; None where their numbers are not kept.
        attitudes: the log behind the headers, on the frames' clock, where there is one.
    """

    name: str
    format: str
    camera: Camera | None
    headers: Sequence[FrameHeader]
    load: Loader
    mount_rpy_rad: MountRpy | None = None
    notes: tuple[str, ...] = ()
    live: bool = False
    reading: Reading | None = None
    attitudes: AttitudeLog | None = None

    @property
    def length(self) -> int:
        """Number of frames."""
        return len(self.headers)

    @property
    def calibrated(self) -> Camera:
        """See `calibrated`."""
        return calibrated(self)

    def read(self, index: int, *, with_truth: bool = True) -> Frame:
        """The frame at an index.

        Raises:
            FrameError: the image or its truth cannot be read or has another size than the camera.
        """
        return checked(self._frame(index, with_truth))

    def frames(self, start: int = 0) -> Iterator[Frame | FrameError]:
        """Frames as far as they can be had.

        A truth that cannot be read is left out; an image of another size than the camera's stays as it is.
        """
        for index in range(start, self.length):
            yield self._as_far_as_readable(index)

    def select(self, indices: Sequence[int]) -> "Recording":
        """Some of the frames as a recording of their own.

        Example:
            >>> recording.select(range(10)).length   # doctest: +SKIP
            10
        """
        headers = [self.headers[index] for index in indices]
        return replace(self, headers=headers, load=_Selected(self.load, tuple(indices)))

    def read_as(self, words: str) -> "Recording":
        """The recording with its attitudes read by another convention; see `parse_convention`.

        Raises:
            InputError: words that are not known, or the attitude's numbers are not kept.
        """
        if self.reading is None:
            raise InputError(
                self.name, f"is {self.format}, which has one convention", "leave --convention out"
            )
        reading = replace(self.reading, convention=parse_convention(words, self.reading.convention))
        known = [header.as_read is not None for header in self.headers]
        numbers = np.array([header.as_read for header in self.headers if header.as_read is not None])
        ups = iter(reading.convention.ups_in_camera(numbers, reading.mount))
        headers = [
            replace(header, up_cam=next(ups)) if there else header
            for header, there in zip(self.headers, known, strict=True)
        ]
        return replace(self, headers=headers, reading=reading)

    def stop(self) -> None:
        """Nothing to stop: frames come as fast as they are asked for."""

    def _frame(self, index: int, with_truth: bool) -> Frame:
        header, pixels = self.headers[index], self.load(index, with_truth)
        truth = pixels.truth if header.labelled else None
        return Frame(
            **vars(header), image=pixels.image, camera=self.camera, truth=truth, ranges=pixels.ranges
        )

    def _as_far_as_readable(self, index: int) -> Frame | FrameError:
        for with_truth in (True, False):
            try:
                return self._frame(index, with_truth)
            except FrameError as error:
                _, problem, hint = error.args
        return FrameError(self.headers[index].name, problem, hint)


@dataclass(frozen=True)
class _Selected:
    load: Loader
    indices: tuple[int, ...]

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        return self.load(self.indices[index], with_truth)
