"""A learner at a camera that gives no picture ends when it is told to."""

import threading
import time
from types import SimpleNamespace
from typing import Any

import cv2
import pytest
from test_fly import Line

from horizon_dl.calibration.calibration import Calibration
from horizon_dl.geometry.camera import Camera
from horizon_dl.online.real_time import run_in_real_time
from horizon_dl.sources.camera import CameraSource
from horizon_dl.sources.with_autopilot import WithAutopilot
from horizon_dl.vehicle.mavlink import Link

CAMERA = Camera("pinhole", 32, 24, 30.0, 30.0, 15.5, 11.5)


class Dead:
    """OpenCV's camera, open but without pictures."""

    def __init__(self, device: object) -> None:
        pass

    def isOpened(self) -> bool:  # noqa: N802
        return True

    def get(self, what: int) -> float:
        return 0.0

    def read(self) -> tuple[bool, Any]:
        return False, None

    def release(self) -> None:
        pass


def test_a_learner_at_a_dead_camera_waits_for_it_and_ends_when_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "VideoCapture", Dead)
    monkeypatch.setattr("horizon_dl.sources.camera.REOPEN_S", 60.0)
    closed = threading.Event()
    line = Line()
    monkeypatch.setattr(line, "close", closed.set)
    source = WithAutopilot(CameraSource("camera:0", Calibration(CAMERA)), lambda: Link(line))
    items = lambda: enumerate(source.frames())  # noqa: E731
    run: Any = SimpleNamespace(source=source, stopped=False, position=0, items=items)
    run.keeper = SimpleNamespace(due=lambda position: False)
    before = threading.active_count()
    ended = threading.Event()
    learner = threading.Thread(target=lambda: (run_in_real_time(run, 1.0), ended.set()), daemon=True)
    learner.start()
    assert not ended.wait(0.5)  # a camera may come back
    start = time.monotonic()
    run.stopped = True
    assert ended.wait(5.0)
    assert time.monotonic() - start < 0.9  # not only given up on after a second
    assert closed.wait(1.0)  # the autopilot's line, too
    learner.join(1.0)
    assert threading.active_count() == before
