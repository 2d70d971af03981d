"""A film with the log of its attitude; the times of its frames are the container's own."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.attitude_log import read_attitude
from horizon_dl.data.calibration.calibration import read_calibration
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.images import MOST_PIXELS
from horizon_dl.data.source import Pixels, Recording
from horizon_dl.errors import FrameError, InputError

NAME = "film"
NEEDS = "a film (mp4, mov, avi, mkv, webm), with --camera and --attitude"
DAMAGED = (OSError, ValueError, ArithmeticError, LookupError, RuntimeError, MemoryError)
SUFFIXES = {".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".ts"}


def recognises(path: Path) -> bool:
    """Whether the path is a film's."""
    return path.is_file() and path.suffix.lower() in SUFFIXES


def read(path: Path, given: Given) -> Recording:
    """Opens a film; its frames are decoded when asked for, fastest in their order.

    Raises:
        InputError: it is no film, or --camera or --attitude is missing or wrong.
    """
    calibration = None if given.camera is None else read_calibration(given.camera, imu_axes=given.imu_axes)
    log = None if given.attitude is None else read_attitude(given.attitude)
    if given.needs_attitude and (log is None or calibration is None):
        missing = "--attitude" if log is None else "--camera"
        raise InputError(path, f"is a film without {missing}", "a film needs --camera and --attitude")
    stamps, seconds = time_stamps(path)
    names = [f"{index:06d}" for index in range(len(stamps))]
    if log is None or calibration is None:
        headers = [FrameHeader(name, time_s) for name, time_s in zip(names, seconds, strict=True)]
    else:
        mount, offset_s = calibration.mount_rpy_rad, given.time_offset_s
        headers = [
            log.header(name, time_s, mount, offset_s) for name, time_s in zip(names, seconds, strict=True)
        ]
    turns = 0 if calibration is None else calibration.rotate_quarter_turns_ccw
    return Recording(
        path.stem,
        NAME,
        None if calibration is None else calibration.camera,
        headers,
        FilmLoader(path, tuple(stamps), turns),
        None if calibration is None else calibration.mount_rpy_rad,
        () if calibration is None else calibration.notes,
        reading=None if calibration is None else reading_with(Convention(), calibration.mount_rpy_rad),
    )


def time_stamps(path: Path) -> tuple[list[int], list[float]]:
    """Presentation time stamps in the container's own unit, sorted, and seconds since the first one.

    Raises:
        InputError: the file holds no film.
    """
    with _opened(path) as container:
        stream = container.streams.video[0]
        try:
            stamps = sorted(packet.pts for packet in container.demux(stream) if packet.pts is not None)
            unit_s = float(stream.time_base)
        except (*DAMAGED, TypeError) as error:
            raise InputError(path, f"is damaged ({type(error).__name__})", "copy it again") from None
    if not stamps:
        raise InputError(path, "holds no frames", "copy it again")
    return stamps, [(stamp - stamps[0]) * unit_s for stamp in stamps]


@dataclass
class FilmLoader:
    """Decodes frames of a film, forward from where it stands, else from the key frame before.

    Attributes:
        path: of the film.
        stamps: presentation time stamps of the frames.
        rotate_quarter_turns_ccw: how a decoded image is turned to be upright.
    """

    path: Path
    stamps: tuple[int, ...]
    rotate_quarter_turns_ccw: int = 0
    _images: Iterator[tuple[int, NDArray[np.uint8]]] | None = field(default=None, repr=False)
    _next: int = 0

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        """See `Loader`."""
        if self._images is None or not self._next <= index < self._next + 30:
            self._images = _decoded(self.path, self.stamps[index])
        try:
            for stamp, image in self._images:
                if stamp >= self.stamps[index]:
                    self._next = index + 1
                    return Pixels(np.ascontiguousarray(np.rot90(image, self.rotate_quarter_turns_ccw)))
        except DAMAGED as error:  # FFmpeg's errors are all one of these
            self._images = None
            problem = f"cannot be decoded at frame {index} ({type(error).__name__})"
            raise FrameError(self.path, problem, "copy the film again") from None
        self._images = None
        raise FrameError(self.path, f"ends before frame {index}", "copy the film again")

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_images": None}


def _decoded(path: Path, stamp: int) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Time stamps and RGB images from the key frame at or before a time stamp on."""
    with _opened(path) as container:
        stream = container.streams.video[0]
        stream.thread_type = "AUTO"
        container.seek(stamp, stream=stream)
        for frame in container.decode(stream):
            if frame.width * frame.height > MOST_PIXELS:
                raise ValueError("a frame is too large")
            if frame.pts is not None:
                yield frame.pts, frame.to_ndarray(format="rgb24")


def _opened(path: Path) -> Any:
    try:
        import av
    except ImportError:
        raise InputError(path, "is a film", "install horizon-dl[logs] to read it") from None
    try:
        container = av.open(str(path))
    except (av.error.FFmpegError, OSError):
        raise InputError(path, "is no film that can be read", "convert it to MP4 with H.264") from None
    if not container.streams.video:
        container.close()
        raise InputError(path, "holds no film", "give a file with a video track")
    return container
