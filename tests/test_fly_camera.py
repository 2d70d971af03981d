"""Cameras of the onboard loop: OpenCV's, a delay, the floor under a car; and a signed flight over a video."""

import argparse
import json
import math
import socket
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import make_sets
import numpy as np
import pytest
from flat_model import FlatModel
from pymavlink.dialects.v20 import common

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.cli import fly
from horizon_dl.data.attitude_log import ConstantAttitude
from horizon_dl.data.frame import Frame
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.ranging.sectors import Outcome
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.flight_loop import FlightLoop, FlightSettings
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.perception import Perception
from horizon_dl.sources import camera as camera_module
from horizon_dl.sources.camera import CameraSource
from horizon_dl.sources.replay import replay
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.obstacle_distance import UNKNOWN_CM

pytestmark = pytest.mark.usefixtures("trusting")

CAMERA = Camera("pinhole", 32, 24, 30.0, 30.0, 15.5, 11.5)
MOUNT = (0.0, math.radians(-25), 0.0)
KEY = bytes(range(32))


class Silent:
    """A line on which nothing comes."""

    whole_messages = True

    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.at_s: list[float] = []

    def receive(self, timeout_s: float) -> tuple[bytes, None]:
        time.sleep(min(timeout_s, 0.01))
        return b"", None

    def accept(self, peer: object) -> bool:
        return True

    def send(self, content: bytes) -> bool:
        self.sent.append(content)
        self.at_s.append(time.monotonic())
        return True

    def close(self) -> None:
        pass


class FakeCapture:
    """OpenCV's camera, which between two times stands still or fails."""

    stall: tuple[float, float] = (math.inf, math.inf)
    fails: tuple[float, float] = (math.inf, math.inf)
    opened = 0

    def __init__(self, device: object) -> None:
        assert device == 3
        type(self).opened += 1

    def isOpened(self) -> bool:  # noqa: N802
        return not self.fails[0] < time.monotonic() < self.fails[1]

    def get(self, what: int) -> float:
        return 0.0

    def read(self) -> tuple[bool, Any]:
        time.sleep(0.03)
        start, end = self.stall
        while start < time.monotonic() < end:
            time.sleep(0.01)
        return self.isOpened(), np.zeros((24, 32, 3), np.uint8)

    def release(self) -> None:
        pass


def messages_of(sent: list[bytes], kind: str, key: bytes | None = None) -> list[Any]:
    parser = common.MAVLink(None)
    parser.robust_parsing = True
    if key:
        parser.signing.secret_key = key
    found = [message for content in sent for message in parser.parse_buffer(content) or []]
    return [message for message in found if message.get_type() == kind]


def level_camera() -> CameraSource:
    return CameraSource("camera:3", Calibration(CAMERA, 0, MOUNT), attitude=ConstantAttitude(0.0, 0.0))


@pytest.mark.parametrize("trouble", ["stall", "fails"])
def test_an_opencv_camera_in_trouble_is_unknown_and_comes_back(
    trouble: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    perception, line = Perception.of(FlatModel(CAMERA), MOUNT), Silent()
    now = time.monotonic()
    start, end = now + 1.0, now + 2.0
    monkeypatch.setattr(cv2, "VideoCapture", FakeCapture)
    monkeypatch.setattr(FakeCapture, trouble, (start, end))
    flight = FlightLoop(
        perception, Link(line), FlightSettings(rate_hz=50, mount_rpy_rad=MOUNT, recorded_attitude=True)
    )
    camera = level_camera()
    flight.run(camera.frames(), 3.7, camera.stop)
    known = [
        (at_s, set(message.distances) != {UNKNOWN_CM})
        for at_s, content in zip(line.at_s, line.sent, strict=True)
        for message in messages_of([content], "OBSTACLE_DISTANCE")
    ]
    assert any(good for at_s, good in known if at_s < start)
    in_the_stall = [good for at_s, good in known if start + 0.4 < at_s < end]
    assert in_the_stall
    assert not any(in_the_stall)
    assert any(good for at_s, good in known if at_s > end)
    later = [content for at_s, content in zip(line.at_s, line.sent, strict=True) if at_s > start]
    texts = [m.text for m in messages_of(later, "STATUSTEXT")]
    assert any("camera stale" in text for text in texts)
    assert "Obstacles: recovered" in texts


def test_a_camera_that_never_comes_back_is_opened_again_until_the_flight_ends(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    perception, line = Perception.of(FlatModel(CAMERA), MOUNT), Silent()
    monkeypatch.setattr(cv2, "VideoCapture", FakeCapture)
    monkeypatch.setattr(FakeCapture, "opened", 0)
    monkeypatch.setattr(FakeCapture, "fails", (time.monotonic() + 0.3, math.inf))
    monkeypatch.setattr(camera_module, "REOPEN_S", 0.05)
    flight = FlightLoop(perception, Link(line), FlightSettings(mount_rpy_rad=MOUNT, recorded_attitude=True))
    start = time.monotonic()
    camera = level_camera()
    flight.run(camera.frames(), 1.0, camera.stop)
    assert 1.0 <= time.monotonic() - start < 1.7
    assert 3 < FakeCapture.opened < 20
    assert not [thread for thread in threading.enumerate() if thread.name == "frames"]


def test_a_camera_in_its_pause_ends_at_once_when_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "VideoCapture", FakeCapture)
    monkeypatch.setattr(FakeCapture, "fails", (time.monotonic() + 0.1, math.inf))
    monkeypatch.setattr(camera_module, "REOPEN_S", 60.0)
    camera = level_camera()
    reader = threading.Thread(target=lambda: list(camera.frames()), daemon=True)
    reader.start()
    time.sleep(0.4)
    assert reader.is_alive()
    camera.stop()
    reader.join(1.0)
    assert not reader.is_alive()


@pytest.mark.parametrize("loop", [False, True])
def test_a_replay_without_a_frame_that_can_be_read_ends_with_one_line(loop: bool, tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path / "set")
    recording = open_recording(folder)
    for header in recording.headers:
        (folder / header.name).write_bytes(b"no picture")
    with pytest.raises(InputError, match="no frame that can be read"):
        next(replay(recording, time.monotonic, loop=loop))


def test_a_picture_is_as_old_as_the_cameras_delay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "VideoCapture", FakeCapture)
    camera = CameraSource("camera:3", clock=lambda: 100.0, delay_s=0.12)
    frame = next(camera.frames())
    assert isinstance(frame, Frame)
    assert frame.time_s == pytest.approx(99.88)


def test_a_picture_is_stamped_before_it_is_converted(monkeypatch: pytest.MonkeyPatch) -> None:
    def slow(image: Any, code: int) -> Any:
        time.sleep(0.1)
        return image

    monkeypatch.setattr(cv2, "VideoCapture", FakeCapture)
    monkeypatch.setattr(cv2, "cvtColor", slow)
    frame = next(CameraSource("camera:3").frames())
    assert isinstance(frame, Frame)
    assert time.monotonic() - frame.time_s > 0.09


def test_the_attitude_is_that_of_the_pictures_time() -> None:
    perception = Perception.of(FlatModel(CAMERA), MOUNT)
    flight = FlightLoop(perception, Link(Silent()), FlightSettings(mount_rpy_rad=MOUNT), lambda: 50.0)
    for step in range(101):  # rolls by 1 rad/s
        flight.autopilot.buffer.add(49 + step / 100, quaternion_from_rpy(step / 100, 0.0, 0.4))
    pose = flight._pose(Frame("a", 49.375, image=np.zeros((24, 32, 3), np.uint8)))
    assert pose is not None
    up_cam, yaw, height = pose
    np.testing.assert_allclose(up_cam, up_in_camera(quaternion_from_rpy(0.375, 0, 0), MOUNT), atol=1e-9)
    assert yaw == pytest.approx(0.4)
    assert height is None


def test_a_car_is_ranged_on_its_road(tmp_path: Path) -> None:
    recording = open_recording(make_sets.kitti(tmp_path, oxts="49 8 110 0.0 0.05 0.0"))
    picture = next(replay(recording, time.monotonic))
    assert picture.up_cam is not None
    assert picture.floor_up_cam is not None
    assert np.degrees(np.arccos(picture.up_cam @ picture.floor_up_cam)) == pytest.approx(2.86, abs=0.01)

    class Wall(FlatModel):
        def predict(self, image: Any, up_cam: Any = None) -> Any:
            # What rises over the road at 10 m; the model's own horizon does not matter.
            found = super().predict(image, picture.floor_up_cam)
            p_above = np.where(found.elevation > -math.atan(1.65 / 10), 0.5, 0.02).astype(np.float32)
            return SimpleNamespace(p_above=p_above, elevation=found.elevation)

    line = Silent()
    perception = Perception.of(Wall(recording.camera), (0.0, 0.0, 0.0), frames=1)
    # This model answers nothing when asked for its rays.
    perception.rays = np.asarray(Perception.of(FlatModel(recording.camera), (0, 0, 0)).rays)
    flight = FlightLoop(perception, Link(line), FlightSettings(recorded_attitude=True))
    flight.look(picture)
    found = flight._newest.found
    assert found is not None
    met = found.outcome == Outcome.OBSTACLE
    assert met.any()
    np.testing.assert_allclose(found.distance_m[met], 10.0, rtol=0.2)


@pytest.mark.parametrize("delay", ["0.3", "-0.1", "nan"])
def test_delays_that_make_no_sense_are_one_line(delay: str, tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path / "set")
    with pytest.raises(InputError, match="--camera-delay"):
        fly.run(
            parsed("m", "--source", str(folder), "--mavlink", "udpout:127.0.0.1:9", f"--camera-delay={delay}")
        )


def parsed(*arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    fly.add_arguments(parser)
    return parser.parse_args(arguments)


def film_of(path: Path, frames: int) -> Path:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 20.0, (32, 24))
    assert writer.isOpened()
    for _ in range(frames):
        writer.write(np.full((24, 32, 3), 90, np.uint8))
    writer.release()
    return path


def test_a_signed_flight_over_a_video(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the command's options to the autopilot and back; an intruder without the key changes nothing."""
    camera = tmp_path / "camera.yaml"
    camera.write_text(make_sets.CAMERA_YAML.replace("[0.0, 0.0, 0.0]", "[0.0, -25.0, 0.0]"))
    assert read_calibration(camera).mount_rpy_rad == pytest.approx(MOUNT)
    (tmp_path / "key").write_bytes(KEY)
    monkeypatch.setattr(ObstacleModel, "load", lambda *_: FlatModel(CAMERA))
    peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    peer.bind(("127.0.0.1", 0))
    peer.settimeout(0.05)
    received: list[bytes] = []
    stop = threading.Event()

    def autopilot() -> None:
        mine, intruder = common.MAVLink(None, 1, 1), common.MAVLink(None, 1, 1)
        mine.signing.secret_key, mine.signing.sign_outgoing = KEY, True
        mine.signing.timestamp = int((time.time() - 1420070400) * 1e5)
        address = None
        while not stop.is_set():
            try:
                content, address = peer.recvfrom(1000)
                received.append(content)
            except TimeoutError:
                pass
            if address is None:
                continue
            now_ms = int(time.monotonic() * 1e3)
            level = common.MAVLink_attitude_quaternion_message(now_ms, 1, 1e-7 * (now_ms % 97), 0, 0, 0, 0, 0)
            upside_down = common.MAVLink_attitude_quaternion_message(now_ms + 5, 0, 1, 0, 0, 0, 0, 0)
            height = common.MAVLink_distance_sensor_message(0, 10, 4000, 150, 0, 0, 25, 0)
            for message in (level, height):
                peer.sendto(message.pack(mine), address)
            peer.sendto(upside_down.pack(intruder), address)

    thread = threading.Thread(target=autopilot, daemon=True)
    thread.start()
    arguments = parsed(
        *("m.onnx", "--source", str(film_of(tmp_path / "v.avi", 30)), "--camera", str(camera)),
        *("--mavlink", f"udpout:127.0.0.1:{peer.getsockname()[1]}", "--rate", "50"),
        *(
            "--signing-key",
            str(tmp_path / "key"),
            "--camera-delay",
            "0.02",
            "--out",
            str(tmp_path / "f.json"),
        ),
    )
    fly.run(arguments)
    stop.set()
    thread.join(2)
    peer.close()
    figures = json.loads((tmp_path / "f.json").read_text())
    assert figures["received"]["accepted"] > 20
    assert figures["received"]["bad_signature"] > 10
    assert figures["latency"]["median_ms"] > 20  # counted from the exposure
    signed = messages_of(received, "OBSTACLE_DISTANCE", KEY)
    clear = sum(message.distances[0] == 1001 for message in signed)
    assert clear > 0.3 * len(signed) > 10
    assert {cm for message in signed for cm in message.distances} == {1001, UNKNOWN_CM}
    assert not messages_of(received, "OBSTACLE_DISTANCE", bytes(32))
