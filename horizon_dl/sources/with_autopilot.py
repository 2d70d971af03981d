"""A camera whose frames get the autopilot's attitude at their time."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError
from horizon_dl.geometry.attitude import up_in_camera, yaw_of
from horizon_dl.sources.camera import CameraSource
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.telemetry import Autopilot

AttitudeAt = Callable[[float], NDArray[np.float64] | None]


class WithAutopilot:
    """A `FrameSource` of a camera and an autopilot.

    Args:
        camera: with its mount.
        open_link: to the autopilot; open as long as frames are read.
    """

    format = "live"
    length: int | None = None
    live = True
    notes: tuple[str, ...] = ()

    def __init__(self, camera: CameraSource, open_link: Callable[[], Link]) -> None:
        self._camera, self._open_link = camera, open_link
        self.name, self.camera, self.mount_rpy_rad = camera.name, camera.camera, camera.mount_rpy_rad

    def frames(self, start: int = 0) -> Iterator[Frame | FrameError]:
        """See `CameraSource`; `up_cam` is None where the autopilot's attitude is not known."""
        mount = self.mount_rpy_rad or (0.0, 0.0, 0.0)
        with _listening(self._open_link()) as attitude_at:
            for frame in self._camera.frames(start):
                q = None if isinstance(frame, FrameError) else attitude_at(frame.time_s)
                if q is None or isinstance(frame, FrameError):
                    yield frame
                else:
                    yield replace(frame, up_cam=up_in_camera(q, mount), yaw_rad=yaw_of(q))

    def stop(self) -> None:
        """See `FrameSource`."""
        self._camera.stop()


@contextmanager
def _listening(link: Link) -> Iterator[AttitudeAt]:
    """Attitudes by time while a thread listens; what ended that thread is raised when one is asked for."""
    autopilot, stopped = Autopilot(), threading.Event()
    failed: list[Exception] = []

    def listen() -> None:
        try:
            autopilot.listen(link, stopped)
        except Exception as error:  # whatever a line raises: a deaf learner would just idle
            failed.append(error)

    def attitude_at(time_s: float) -> NDArray[np.float64] | None:
        if failed:
            raise failed[0]
        return autopilot.attitude_at(time_s, stopped)

    thread = threading.Thread(target=listen, name="autopilot", daemon=True)
    thread.start()
    try:
        yield attitude_at
    finally:
        stopped.set()
        thread.join(1.0)
        link.close()
