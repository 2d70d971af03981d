"""The verb `fly`: options, one-line errors, a short replay on loopback, and no torch on board."""

import argparse
import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import make_sets
import numpy as np
import pytest
from flat_model import FlatModel

from horizon_dl.cli import fly
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel

pytestmark = pytest.mark.usefixtures("trusting")


def parsed(*arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    fly.add_arguments(parser)
    return parser.parse_args(arguments)


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    """Twenty pictures in 0.4 s from a camera that looks 25 degrees down, 1.5 m up."""
    rows = [f"images/{i:02d}.png,{0.02 * i},0.0,0.0,0.0,1.5" for i in range(20)]
    camera = make_sets.CAMERA_YAML.replace("[0.0, 0.0, 0.0]", "[0.0, -25.0, 0.0]")
    return make_sets.images_csv(tmp_path / "flight", rows, camera=camera)


@pytest.fixture
def model(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    camera = open_recording(flight).camera
    monkeypatch.setattr(ObstacleModel, "load", lambda *_: FlatModel(camera))


def listening() -> socket.socket:
    peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    peer.bind(("127.0.0.1", 0))
    peer.settimeout(0.2)
    return peer


def heard(peer: socket.socket) -> list[Any]:
    """All MAVLink messages that came; closes the socket."""
    from pymavlink.dialects.v20 import common

    parser, messages = common.MAVLink(None), []
    try:
        while True:
            messages += parser.parse_buffer(peer.recv(1000)) or []
    except TimeoutError:
        peer.close()
    return messages


def test_a_replay_reaches_the_peer(flight: Path, model: None, tmp_path: Path, capsys: Any) -> None:
    peer = listening()
    out = tmp_path / "figures.json"
    url = f"udpout:127.0.0.1:{peer.getsockname()[1]}"
    fly.run(parsed("m.onnx", "--source", str(flight), "--mavlink", url, "--rate", "50", "--out", str(out)))
    messages = heard(peer)
    distances = [m.distances for m in messages if m.get_type() == "OBSTACLE_DISTANCE"]
    assert any(one[0] == 1001 for one in distances)
    assert {m.get_srcComponent() for m in messages} == {196}
    figures = json.loads(out.read_text())
    assert figures["messages"]["sent"] + 1 == len(distances)  # and the last "unknown"
    assert figures["pictures"]["looked_at"] >= 3  # of 20 in 0.4 s; a busy machine skips
    assert "from image to message" in capsys.readouterr().out


class BoxModel(FlatModel):
    """Sees a box all around, 0.3 m high and 2 m away; the camera is 1.5 m over the floor."""

    def predict(self, image: Any, up_cam: Any = None) -> Any:
        found = super().predict(image, up_cam)
        depression = -found.elevation
        box = (np.tan(depression) < 1.5 / 2.0) & (np.tan(depression) > (1.5 - 0.3) / 2.0)
        found.p_above[box] = 0.8
        return found


@pytest.mark.parametrize(
    ("options", "blocked"),
    [
        ([], True),
        (["--vehicle-height", "1.5,0.1"], True),
        (["--vehicle-height", "0.6,0.1"], False),
        (["--connected-only"], False),
    ],
)
def test_a_low_box_blocks_a_vehicle_that_reaches_down_to_it(
    flight: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], blocked: bool
) -> None:
    camera = open_recording(flight).camera
    monkeypatch.setattr(ObstacleModel, "load", lambda *_: BoxModel(camera))
    peer = listening()
    url = f"udpout:127.0.0.1:{peer.getsockname()[1]}"
    fly.run(parsed("m.onnx", "--source", str(flight), "--mavlink", url, "--rate", "50", *options))
    messages = heard(peer)
    ahead = {m.distances[0] for m in messages if m.get_type() == "OBSTACLE_DISTANCE"} - {65535}
    assert ahead
    if blocked:
        assert all(150 < distance < 250 for distance in ahead)
    else:
        assert ahead == {1001}


def test_sigterm_ends_the_flight_in_order(flight: Path, model: None, capsys: Any) -> None:
    before = signal.getsignal(signal.SIGTERM)
    timer = threading.Timer(0.7, os.kill, (os.getpid(), signal.SIGTERM))
    timer.start()
    start = time.monotonic()
    try:
        fly.run(parsed("m", "--source", str(flight), "--mavlink", "udpout:127.0.0.1:9", "--loop"))
    finally:
        timer.cancel()  # a flight that failed before must not take the tests along
    assert time.monotonic() - start < 5
    assert "looked at" in capsys.readouterr().out
    assert signal.getsignal(signal.SIGTERM) == before


def test_the_mount_comes_from_the_data_set(flight: Path) -> None:
    arguments = parsed("m", "--source", str(flight), "--mavlink", "udpout:127.0.0.1:1")
    settings = fly._settings(arguments, fly._source(arguments))
    assert settings.mount_rpy_rad == pytest.approx((0.0, math.radians(-25), 0.0))
    assert settings.recorded_attitude


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        (["--rate", "5"], "--rate 5"),
        (["--rate", "nan"], "--rate nan"),
        (["--filter", "2"], "--filter 2"),
        (["--speed", "0"], "--speed 0"),
        (["--system", "300"], "--system 300"),
        (["--speed", "nan"], "--speed nan"),
        (["--min-distance", "3", "--max-distance", "2"], "make no interval"),
        (["--max-distance", "nan"], "make no interval"),
        (["--max-distance", "inf"], "make no interval"),
        (["--height", "-1"], "--height -1"),
        (["--height", "nan"], "--height nan"),
        (["--duration", "nan"], "--duration nan"),
        (["--duration", "0"], "--duration 0"),
    ],
)
def test_wrong_options_are_one_line(flight: Path, model: None, more: list[str], problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        fly.run(parsed("m", "--source", str(flight), "--mavlink", "udpout:127.0.0.1:9", *more))


def test_a_camera_needs_its_mount_and_the_autopilots_attitude() -> None:
    with pytest.raises(InputError, match="how the camera is mounted"):
        fly.run(parsed("m", "--source", "camera:0", "--mavlink", "udpout:127.0.0.1:9"))
    with pytest.raises(InputError, match="needs a recording"):
        fly.run(
            parsed("m", "--source", "camera:0", "--mavlink", "udpout:127.0.0.1:9", "--attitude", "recorded")
        )


def test_another_camera_than_the_models_is_one_line(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = Camera("pinhole", 64, 48, 60.0, 60.0, 31.5, 23.5)
    monkeypatch.setattr(ObstacleModel, "load", lambda *_: FlatModel(other))
    with pytest.raises(InputError, match="another camera"):
        fly.run(parsed("m", "--source", str(flight), "--mavlink", "udpout:127.0.0.1:9"))


def test_a_camera_file_of_another_camera_or_that_looks_straight_down_is_one_line(
    flight: Path, model: None, tmp_path: Path
) -> None:
    right = (flight / "camera.yaml").read_text()
    url = ("--mavlink", "udpout:127.0.0.1:9")
    for wrong, problem in (
        (right.replace("fx: 30.0", "fx: 90.0"), "camera.yaml: is of another camera"),
        (right.replace("[0.0, -25.0, 0.0]", "[0.0, -90.0, 0.0]"), "straight up or down"),
    ):
        assert wrong != right
        (tmp_path / "camera.yaml").write_text(wrong)
        with pytest.raises(InputError, match=problem):
            fly.run(parsed("m", "--source", "camera:0", "--camera", str(tmp_path / "camera.yaml"), *url))


def test_a_source_that_is_not_there_is_one_line(flight: Path, model: None, tmp_path: Path) -> None:
    url = ("--mavlink", "udpout:127.0.0.1:9")
    for more in ((), ("--camera", str(flight / "camera.yaml"))):
        with pytest.raises(InputError, match=r"none\.mp4: does not exist"):
            fly.run(parsed("m", "--source", str(tmp_path / "none.mp4"), *url, *more))


def test_a_file_that_is_no_video_is_one_line(flight: Path, model: None, tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("no video")
    more = ("--mavlink", "udpout:127.0.0.1:9", "--camera", str(flight / "camera.yaml"))
    with pytest.raises(InputError, match="is no film that can be read"):
        fly.run(parsed("m", "--source", str(tmp_path / "text.mp4"), *more))


def test_replay_keeps_the_recorded_times(flight: Path) -> None:
    from horizon_dl.sources.replay import replay

    now = [5.0]

    def wait(seconds: float) -> None:
        now[0] += seconds

    frames = replay(open_recording(flight), lambda: now[0], speed=2.0, loop=True, wait=wait)
    times = [next(frames).time_s for _ in range(41)]
    np.testing.assert_allclose(times, 5.0 + 0.01 * np.arange(41), atol=1e-9)


def test_what_flies_needs_no_torch() -> None:
    code = (
        "import sys, horizon_dl.runtime.flight_loop, horizon_dl.sources.camera, "
        "horizon_dl.runtime.perception, horizon_dl.vehicle.mavlink, horizon_dl.cli.fly\n"
        "bad = {'torch', 'kornia', 'skimage', 'sklearn', 'scipy', 'matplotlib', 'pymavlink', 'cv2'}\n"
        "sys.exit(str(bad & set(sys.modules)) if bad & set(sys.modules) else 0)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
