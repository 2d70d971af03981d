"""Cameras and network streams, by OpenCV; their frames come without an attitude."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration
from horizon_dl.data.attitude_log import ConstantAttitude
from horizon_dl.data.frame import Frame, FrameHeader
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import MountRpy
from horizon_dl.geometry.camera import Camera

Clock = Callable[[], float]

CAMERA_PREFIX = "camera:"
REOPEN_S = 0.5
"""A camera or stream that gave no picture is opened again after this time."""


def is_live(source: str) -> bool:
    """Whether a source is a camera or a stream's address, and no file or folder.

    Example:
        >>> is_live("camera:0"), is_live("rtsp://127.0.0.1/a"), is_live("flight/")
        (True, True, False)
    """
    return source.startswith(CAMERA_PREFIX) or "://" in source


class CameraSource:
    """A camera (`camera:0`) or a stream's address as a `FrameSource`.

    One that fails is opened again and again until it gives pictures. The times of the frames are those of
    the caller's clock at which the driver handed them over, less the delay.

    Args:
        source: see above.
        calibration: intrinsics, mount, and how pictures are turned; None: nothing is known.
        clock: monotonic seconds.
        delay_s: from exposure to arrival.
        attitude: that of all frames; None: not known here.
    """

    format = "live"
    length: int | None = None
    live = True
    notes: tuple[str, ...] = ()

    def __init__(
        self,
        source: str,
        calibration: Calibration | None = None,
        *,
        clock: Clock = time.monotonic,
        delay_s: float = 0.0,
        attitude: ConstantAttitude | None = None,
    ) -> None:
        self.name = source
        self._attitude = attitude
        self._calibration, self._clock, self._delay_s = calibration, clock, delay_s
        self._stopped = threading.Event()

    @property
    def camera(self) -> Camera | None:
        """Intrinsics of the upright pictures."""
        return None if self._calibration is None else self._calibration.camera

    @property
    def mount_rpy_rad(self) -> MountRpy | None:
        """Of the camera in the body."""
        return None if self._calibration is None else self._calibration.mount_rpy_rad

    def frames(self, start: int = 0) -> Iterator[Frame | FrameError]:
        """Pictures as they come; `start` only numbers them.

        Raises:
            InputError: OpenCV cannot open the source, when the first picture is asked for.
        """
        import cv2

        turns = 0 if self._calibration is None else self._calibration.rotate_quarter_turns_ccw
        for index, (arrival_s, image) in enumerate(self._images(), start):
            rgb = np.rot90(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), turns)
            time_s = arrival_s - self._delay_s
            header = self._header(f"{index:06d}", time_s)
            yield Frame(**vars(header), image=np.ascontiguousarray(rgb), camera=self.camera)

    def stop(self) -> None:
        """See `FrameSource`."""
        self._stopped.set()

    def _header(self, name: str, time_s: float) -> FrameHeader:
        if self._attitude is None:
            return FrameHeader(name, time_s)
        return self._attitude.header(name, time_s, self.mount_rpy_rad or (0.0, 0.0, 0.0))

    def _images(self) -> Iterator[tuple[float, NDArray[Any]]]:
        """When the driver handed over an image, and the image, BGR."""
        opened = _open(self.name)
        if not opened.isOpened():
            problem = f"--source {self.name}"
            raise InputError(problem, "cannot be opened", "give camera:0, a stream's address or a recording")
        try:
            while not self._stopped.is_set():
                good, image = opened.read()
                arrival_s = self._clock()  # before anything is done with the image
                if good:
                    yield arrival_s, image
                else:
                    opened.release()  # a device is opened only once at a time
                    self._stopped.wait(REOPEN_S)
                    opened = _open(self.name)
        finally:
            opened.release()


def _open(source: str) -> Any:
    """OpenCV's object for a source; it says by itself whether it is open."""
    try:
        import cv2
    except ImportError:
        raise InputError(source, "is a camera or stream", "install horizon-dl[drone] to read it") from None

    device = source.removeprefix(CAMERA_PREFIX)
    return cv2.VideoCapture(int(device) if device != source and device.isdigit() else device)
