"""Camera and serial line pulled out of a flight and put back; HORIZON_DL_PULLS says how often."""

import math
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar

import cv2
import numpy as np
import pytest
from flat_model import FlatModel
from test_fly import LEVEL, attitude, codec, decoded, is_known, rangefinder
from test_fly_camera import CAMERA, MOUNT, Silent, level_camera
from test_serial_line import Device

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.flight_loop import FlightLoop, FlightSettings
from horizon_dl.runtime.perception import Perception
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.transport import open_transport

pytestmark = pytest.mark.usefixtures("trusting")

PULLS = int(os.environ.get("HORIZON_DL_PULLS", "2"))
RECOVERS_S = 6.0
"""A line or camera is opened again after half a second; the rest is for a machine that is busy."""


@contextmanager
def flown(
    loop: FlightLoop, frames: Iterator[Frame], stop: Callable[[], None] = lambda: None
) -> Iterator[None]:
    runner = threading.Thread(target=loop.run, args=(frames, None, stop), daemon=True)
    runner.start()
    yield
    assert runner.is_alive(), "the flight has ended"
    loop.stop()
    runner.join(5)
    assert not runner.is_alive()


def until(condition: Callable[[], bool], timeout_s: float) -> float:
    """How long it took, s."""
    start = time.monotonic()
    while not condition():
        assert time.monotonic() - start < timeout_s, "not within the time"
        time.sleep(0.01)
    return time.monotonic() - start


def told(what: str, took_s: list[float]) -> None:
    print(
        f"{what}: {len(took_s)} pulls, back within median {np.median(took_s):.2f} s, most {max(took_s):.2f} s"
    )


class Cable:
    """An autopilot at the far end of a serial line that can be pulled: it talks, and keeps what it hears."""

    def __init__(self, device: Device) -> None:
        self.device, self.heard, self.plugged, self.ended = device, [b""], True, False
        self._at_work = threading.Lock()
        self._thread = threading.Thread(target=self._talk, daemon=True)
        self._thread.start()

    def pull(self) -> None:
        with self._at_work:
            self.plugged = False
            self.device.pull()

    def plug(self) -> None:
        with self._at_work:
            self.device.plug()
            self.heard, self.plugged = [b""], True

    def known(self) -> bool:
        """Whether the newest distances that came over the line since it was plugged in tell anything."""
        messages = decoded([b"".join(self.heard[-40:])])
        return bool(messages) and is_known(messages[-1])

    def end(self) -> None:
        self.ended = True
        self._thread.join(2)

    def _talk(self) -> None:
        mav = codec()
        while not self.ended:
            with self._at_work:
                if self.plugged:
                    os.write(self.device.controller, attitude(mav, time.monotonic(), LEVEL))
                    os.write(self.device.controller, rangefinder(mav, 1.0))
                    self.heard.append(self.device.sent())
            time.sleep(0.02)


def blank() -> Iterator[Frame]:
    while True:
        time.sleep(0.03)
        yield Frame("a", time.monotonic(), image=np.zeros((24, 32, 3), np.uint8))


def test_the_serial_line_pulled_and_put_back(tmp_path: Path) -> None:
    cable = Cable(Device(tmp_path / "ttyAUTOPILOT"))
    link = Link(open_transport(f"serial:{cable.device.path}"))
    loop = FlightLoop(Perception.of(FlatModel(CAMERA), MOUNT), link, FlightSettings(mount_rpy_rad=MOUNT))
    took_s: list[float] = []
    with flown(loop, blank()):
        until(cable.known, 10.0)
        for _ in range(PULLS):
            cable.pull()
            seen = loop.pictures_seen
            time.sleep(0.4)
            cable.plug()
            took_s.append(until(cable.known, RECOVERS_S))
            assert loop.pictures_seen >= seen
    cable.end()
    link.close()
    assert loop.unsent > 0
    told("serial line", took_s)


class PulledCamera:
    """OpenCV's camera, out of which the plug is pulled: no pictures, and no device to open."""

    out: ClassVar[threading.Event] = threading.Event()

    def __init__(self, device: object) -> None:
        self._here = not self.out.is_set()

    def isOpened(self) -> bool:  # noqa: N802
        return self._here

    def read(self) -> tuple[bool, Any]:
        time.sleep(0.03)
        self._here &= not self.out.is_set()  # what was opened before stays dead
        return self._here, np.zeros((24, 32, 3), np.uint8)

    def get(self, what: int) -> float:
        return 0.0

    def release(self) -> None:
        pass


def test_the_camera_pulled_and_put_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "VideoCapture", PulledCamera)
    PulledCamera.out.clear()
    line, camera = Silent(), level_camera()
    settings = FlightSettings(mount_rpy_rad=MOUNT, recorded_attitude=True, height_m=1.0)
    loop = FlightLoop(Perception.of(FlatModel(CAMERA), MOUNT), Link(line), settings)
    took_s: list[float] = []

    def known() -> bool:
        messages = decoded(line.sent[-8:])
        return bool(messages) and is_known(messages[-1])

    with flown(loop, camera.frames(), camera.stop):
        until(known, 10.0)
        for _ in range(PULLS):
            PulledCamera.out.set()
            until(lambda: not known(), 3.0)
            PulledCamera.out.clear()
            took_s.append(until(known, RECOVERS_S))
    gaps_s = np.diff(line.at_s)
    assert math.isclose(loop.unsent, 0)
    told("camera", took_s)
    print(f"longest time between two messages {gaps_s.max():.2f} s")
