"""A camera and an autopilot as a stream to learn from."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.calibration.calibration import Calibration
from horizon_dl.data.capture.camera import Stoppable, capture
from horizon_dl.data.capture.stream import Arrival, Stream
from horizon_dl.data.frame import Frame
from horizon_dl.geometry.attitude import up_in_camera
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.telemetry import Autopilot

AttitudeAt = Callable[[float], NDArray[np.float64] | None]


def live_stream(
    source: str, calibration: Calibration, open_link: Callable[[], Link], delay_s: float = 0.0
) -> Stream:
    """Pictures as they come, each with the autopilot's attitude at its time; an index counts arrivals.

    Args:
        source: `camera:0`, a stream's address, or a video file at its own rate.
        calibration: intrinsics, mount, and how pictures are turned.
        open_link: to the autopilot; open as long as frames are read.
        delay_s: from exposure to arrival of a picture.
    """
    captures: list[Stoppable] = []

    def arrivals(start: int) -> Iterator[Arrival]:
        turns = calibration.rotate_quarter_turns_ccw
        pictures = capture(source, time.monotonic, rotate_quarter_turns_ccw=turns, delay_s=delay_s)
        captures.append(pictures)
        with _listening(open_link()) as attitude_at:
            for index, picture in enumerate(pictures, start):
                q = attitude_at(picture.time_s)
                up_cam = None if q is None else up_in_camera(q, calibration.mount_rpy_rad)
                name = f"{index:06d}"
                frame = Frame(name, picture.time_s, picture.image, calibration.camera, up_cam)
                yield Arrival(index, name, picture.time_s, frame)

    def stop() -> None:
        for pictures in captures:
            pictures.stop()

    return Stream(source, "live", calibration.camera, None, arrivals, live=True, stop=stop)


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
