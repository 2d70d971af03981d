"""Real time, videos with an attitude log, and the hand-over of fresh models to the onboard runtime."""

import argparse
import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from pymavlink.dialects.v20 import common
from small_run import small_export, small_run, toy_frames, toy_set
from tiny_online import frame_lines, tiny_options, tiny_run
from toy import CAMERA, write_toy_set

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.cli import fly, main
from horizon_dl.data.frame import Frame
from horizon_dl.data.given import Given
from horizon_dl.errors import FrameError, InputError
from horizon_dl.export.export import export_run, trained_camera
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.online.real_time import LEFT_OUT, PacedFrames, RealTime, run_in_real_time
from horizon_dl.output import write_bytes
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.hot_reload import HotReloadedModel
from horizon_dl.sources.camera import CameraSource
from horizon_dl.sources.with_autopilot import WithAutopilot
from horizon_dl.training.run_folder import Run
from horizon_dl.vehicle.mavlink import open_link


@pytest.fixture(scope="module")
def toy(tmp_path_factory) -> Path:
    return write_toy_set(tmp_path_factory.mktemp("toy") / "set", frames=16)


class Script:
    """PacedFrames at given turns, in place of a clock: the number of frames that come at each `take`."""

    def __init__(self, items: Iterator[tuple[int, Frame | FrameError]], turns: list[int]) -> None:
        self.ended = False
        self._items = items
        self._turns = iter(turns)

    def take(self, _: float) -> tuple[float, tuple[int, Frame | FrameError]] | None:
        if next(self._turns, 1):
            found = next(self._items, None)
            self.ended = found is None
            return None if found is None else (time.monotonic(), found)
        return None


def scripted(toy: Path, out: Path, turns: list[int], **options) -> list[dict]:
    run = tiny_run(toy, out, **options)
    real_time = RealTime(run, Script(run.items(), turns))  # type: ignore[arg-type]
    while real_time.turn():
        pass
    real_time.finish()
    run.finish()
    return frame_lines(out)


def test_the_newest_frame_is_learned_and_the_others_are_left_out(toy, tmp_path):
    # Three frames come at once; then there is time for all three turns of learning from the newest.
    lines = scripted(toy, tmp_path / "run", [1, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0], max_frames=4)
    assert [line["not_learned"] for line in lines] == [LEFT_OUT, LEFT_OUT, None, None]
    assert [line["index"] for line in lines] == [0, 1, 2, 3]
    assert json.loads((tmp_path / "run" / "run.json").read_text())["online"]["not_learned"] == {LEFT_OUT: 2}


def test_frames_that_come_during_learning_are_predicted_between_two_steps(toy, tmp_path):
    # One frame, a turn to begin and a step; two more frames; the first one is then finished all the same.
    lines = scripted(toy, tmp_path / "run", [1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0], max_frames=3)
    assert [line["not_learned"] for line in lines] == [None, LEFT_OUT, None]
    assert all(line["loss"] for line in lines if line["learned"])


def test_with_time_enough_real_time_learns_what_the_plain_run_learns(toy, tmp_path):
    turns = [1, *[0] * 5] * 16
    plain = tiny_run(toy, tmp_path / "plain")
    plain.run()
    plain.finish()
    assert scripted(toy, tmp_path / "run", turns) == frame_lines(tmp_path / "plain")


def test_every_frame_is_predicted_in_real_time(toy, tmp_path, capsys):
    out = tmp_path / "run"
    arguments = ["online", str(toy), "--out", str(out), "--real-time", "--speed", "20", *tiny_options()]
    assert main(arguments) == 0
    lines = frame_lines(out)
    assert [line["index"] for line in lines] == list(range(16))
    assert {line["not_learned"] for line in lines} <= {None, LEFT_OUT}
    info = json.loads((out / "run.json").read_text())
    assert info["online"]["predicted"] == 16
    assert info["online"]["learned"] + info["online"]["not_learned"].get(LEFT_OUT, 0) == 16
    assert info["real_time"]["count"] == 16
    assert "from arrival to prediction" in capsys.readouterr().out


def test_frames_come_at_their_times(toy):
    start = time.monotonic()  # before the thread starts, which a busy machine may let run first
    frames = PacedFrames(enumerate(open_recording(toy).frames()), 2.0)
    for index in range(6):
        found = frames.take(5.0)
        assert found is not None
        assert found[1][0] == index
        assert time.monotonic() - start > 0.05 * index - 0.001
    frames.stop()


def test_an_error_of_the_source_ends_the_run(toy, tmp_path):
    run = tiny_run(toy, tmp_path / "run")

    def broken() -> Iterator[tuple[int, Frame | FrameError]]:
        yield from enumerate(list(open_recording(toy).frames())[:3])
        raise InputError("camera:0", "is gone", "plug it in")

    run.items = broken
    with pytest.raises(InputError, match="plug it in"):
        run_in_real_time(run, 50.0)


@pytest.fixture
def film(toy, tmp_path) -> Path:
    """The toy's frames as a video of 10 frames a second, its attitude at 50 Hz beside it."""
    path = tmp_path / "film.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 10.0, (96, 72))
    assert writer.isOpened()
    for image in sorted((toy / "images").iterdir()):
        writer.write(np.asarray(Image.open(image))[:, :, ::-1])
    writer.release()
    rows = (toy / "frames.csv").read_text().splitlines()[1:]
    times, pitches = zip(*((float(row.split(",")[1]), float(row.split(",")[3])) for row in rows), strict=True)
    fine = np.arange(0, 1.3, 0.02)
    samples = [f"{t},0.0,{np.interp(t, times, pitches)},0.0" for t in fine]
    (tmp_path / "log.csv").write_text("\n".join(["time_s,roll_rad,pitch_rad,yaw_rad", *samples]) + "\n")
    (tmp_path / "camera.yaml").write_text(CAMERA)
    return path


def test_a_video_is_learned_from_with_its_attitude_log(film, toy, tmp_path):
    log, camera, out = tmp_path / "log.csv", tmp_path / "camera.yaml", tmp_path / "run"
    arguments = ["--attitude", str(log), "--camera", str(camera), "--out", str(out), *tiny_options()]
    assert main(["online", str(film), *arguments, "--max-frames", "9"]) == 0
    assert main(["online", str(film), *arguments]) == 0
    lines = frame_lines(out)
    # The log ends at 1.28 s: the frames at 1.3, 1.4 and 1.5 s have no attitude.
    assert [line["not_learned"] for line in lines] == [None] * 13 + ["no attitude"] * 3
    assert [line["time_s"] for line in lines] == pytest.approx([i / 10 for i in range(16)])
    wanted = open_recording(toy)
    for index, frame in enumerate(open_recording(film, given=Given(camera, str(log))).frames()):
        assert isinstance(frame, Frame)
        assert np.abs(frame.image.astype(int) - wanted.read(index).image).mean() < 15  # MJPEG of noise
        if index < 13:
            assert frame.up_cam == pytest.approx(wanted.headers[index].up_cam, abs=1e-6)
    assert json.loads((out / "run.json").read_text())["format"] == "film"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "--attitude"),
        (["--attitude", "none.csv", "--camera", "CAMERA"], "none.csv"),
        (["--attitude", "LOG", "--camera", "none.yaml"], "none.yaml"),
        (["--attitude", "CAMERA", "--camera", "CAMERA"], "camera.yaml"),
        (["--attitude", "LOG", "--camera", "CAMERA", "--speed", "2"], "--real-time"),
    ],
)
def test_wrong_videos_are_one_line(film, tmp_path, capsys, options, words):
    places = {"LOG": str(tmp_path / "log.csv"), "CAMERA": str(tmp_path / "camera.yaml")}
    named = [places.get(word, word) for word in options]
    assert main(["online", str(film), "--out", str(tmp_path / "run"), *named]) == 2
    assert words in capsys.readouterr().err


@contextmanager
def autopilot(quaternion: tuple[float, ...]) -> Iterator[str]:
    """Sends its attitude 50 times a second to whoever has sent it a heartbeat; its address."""
    line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    line.bind(("127.0.0.1", 0))
    line.settimeout(0.02)
    stop = threading.Event()

    def send() -> None:
        codec, address = common.MAVLink(None, 1, 1), None
        while not stop.is_set():
            with suppress(TimeoutError):
                content, address = line.recvfrom(1000)
                assert common.MAVLink(None).parse_char(content).get_type() == "HEARTBEAT"
            if address and quaternion:
                now_ms = int(time.monotonic() * 1e3)
                message = common.MAVLink_attitude_quaternion_message(now_ms, *quaternion, 0, 0, 0)
                line.sendto(message.pack(codec), address)

    thread = threading.Thread(target=send, daemon=True)
    thread.start()
    yield f"udpout:127.0.0.1:{line.getsockname()[1]}"
    stop.set()
    thread.join(2)
    line.close()


class FilmCamera:
    """OpenCV's camera, which gives a film's pictures at the film's pace, and then none."""

    path: Path

    def __init__(self, device: object) -> None:
        self._film = REAL_CAPTURE(str(self.path))
        self._due_s = time.monotonic()

    def isOpened(self) -> bool:  # noqa: N802
        return True

    def read(self):
        time.sleep(max(0.0, self._due_s - time.monotonic()))
        self._due_s += 0.1
        return self._film.read()

    def release(self) -> None:
        self._film.release()


REAL_CAPTURE = cv2.VideoCapture


def test_a_camera_is_learned_from_with_the_autopilots_attitude(film, tmp_path, monkeypatch, capsys):
    camera, out = tmp_path / "camera.yaml", tmp_path / "run"
    monkeypatch.setattr(FilmCamera, "path", film, raising=False)
    monkeypatch.setattr(cv2, "VideoCapture", FilmCamera)
    pitched = quaternion_from_rpy(0.0, -0.2, 1.0)
    options = ["--camera", str(camera), "--out", str(out), *tiny_options()]

    def some(frames: int) -> list[str]:
        return [*options, "--max-frames", str(frames)]

    with autopilot(tuple(pitched)) as url:
        assert main(["online", "camera:0", "--attitude", f"mavlink:{url}", *some(9)]) == 0
        assert main(["online", "camera:0", "--attitude", f"mavlink:{url}", *some(14)]) == 0
        calibration = read_calibration(camera)
        source = WithAutopilot(CameraSource("camera:0", calibration), lambda: open_link(url))
        frames = list(islice(source.frames(), 16))
    lines = frame_lines(out)
    assert [line["index"] for line in lines] == list(range(14))
    # A frame may come before the first attitude, or before there is time to learn from it; the clock goes on.
    assert sum(line["learned"] for line in lines) >= 4
    times = [line["time_s"] for line in lines[:9]]
    assert np.all(np.diff(times) > 0)
    assert times[-1] - times[0] > 0.6  # 0.8 s of film
    # After a stall of the machine some frames come close together; most keep the film's pace.
    steps = np.diff([frame.time_s for frame in frames])
    assert np.median(steps) == pytest.approx(0.1, abs=0.02)
    info = json.loads((out / "run.json").read_text())
    assert info["format"] == "live"
    assert info["real_time"]["count"] == 5
    wanted = up_in_camera(pitched, calibration.mount_rpy_rad)
    known = [frame.up_cam for frame in frames if frame.up_cam is not None]
    assert len(frames) == 16
    assert len(known) >= 12
    np.testing.assert_allclose(known, np.tile(wanted, (len(known), 1)), atol=1e-6)
    assert "going on at frame 9" in capsys.readouterr().err


def test_a_camera_is_predicted_with_the_autopilots_attitude(film, tmp_path, monkeypatch):
    camera, out = tmp_path / "camera.yaml", tmp_path / "out"
    monkeypatch.setattr(FilmCamera, "path", film, raising=False)
    monkeypatch.setattr(cv2, "VideoCapture", FilmCamera)
    (tmp_path / "model.onnx").write_bytes(small_export().content())
    with autopilot(tuple(quaternion_from_rpy(0.0, -0.2, 1.0))) as url:
        words = ["--attitude", f"mavlink:{url}", "--camera", str(camera), "--max-frames", "12"]
        assert main(["predict", str(tmp_path / "model.onnx"), "camera:0", *words, "--out", str(out)]) == 0
    known = [np.isfinite(np.load(path)["elevation_rad"]).any() for path in sorted(out.rglob("*.npz"))]
    assert len(known) == 12
    assert sum(known) >= 6


def test_an_autopilot_that_is_silent_is_one_line(film, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(FilmCamera, "path", film, raising=False)
    monkeypatch.setattr(cv2, "VideoCapture", FilmCamera)
    with autopilot(()) as url:
        options = ["--camera", str(tmp_path / "camera.yaml"), "--out", str(tmp_path / "run"), *tiny_options()]
        more = ["--attitude", f"mavlink:{url}", "--max-frames", "16"]
        assert main(["online", "camera:0", *more, *options]) == 2
    assert "no attitude: 16" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--mavlink", "udpout:127.0.0.1:9"], "--camera"),
        (["--mavlink", "carrier pigeon", "--camera", "CAMERA"], "carrier pigeon"),
        (["--mavlink", "udpout:127.0.0.1:9", "--camera", "CAMERA", "--speed", "2"], "--speed"),
        (["--mavlink", "udpout:127.0.0.1:9", "--camera", "CAMERA", "--camera-delay", "3"], "--camera-delay"),
        (["--mavlink", "udpout:127.0.0.1:9", "--camera", "CAMERA", "--attitude", "LOG"], "--attitude"),
        (["--camera", "CAMERA", "--attitude", "LOG", "--system", "7"], "without an autopilot"),
    ],
)
def test_wrong_autopilots_are_one_line(film, tmp_path, capsys, options, words):
    named = [str(tmp_path / "camera.yaml") if word == "CAMERA" else word for word in options]
    assert main(["online", "camera:0", "--out", str(tmp_path / "run"), *named]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("source", ["camera:0", "rtsp://127.0.0.1/stream"])
def test_a_camera_without_an_autopilot_is_one_line(source, tmp_path, capsys):
    assert main(["online", source, "--out", str(tmp_path / "run")]) == 2
    error = capsys.readouterr().err
    assert f"{source}: has no attitude: nothing says" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("verb", "words"),
    [
        (["train", "camera:0"], "camera:0: is live"),
        (["check-data", "rtsp://127.0.0.1/stream"], "rtsp://127.0.0.1/stream: is live"),
        (
            ["compare", "SET", "--attitude", "mavlink:udpout:127.0.0.1:9"],
            "mavlink:udpout:127.0.0.1:9: is the",
        ),
    ],
)
def test_what_is_live_is_one_line_where_a_recording_is_needed(verb, words, toy, tmp_path, capsys):
    named = [str(toy) if word == "SET" else word for word in verb]
    assert main([*named, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("jump_s", [3600.0, -3600.0])
def test_a_clock_that_was_set_is_not_waited_for(jump_s):
    frame = Frame("a.png", 0.0, None, image=np.zeros((4, 4, 3), np.uint8), camera=CAMERA)
    times = [0.0, 0.1, 0.1 + jump_s, 0.2 + jump_s]
    items = list(enumerate(replace(frame, time_s=time_s) for time_s in times))
    frames = PacedFrames(iter(items), 1.0)
    found = [frames.take(5.0) for _ in items]
    frames.stop()
    came = [one[0] for one in found if one is not None]
    np.testing.assert_allclose(np.diff(came), [0.1, 0.0, 0.1], atol=1e-6)


def other_export(threshold: float, width: int = 96) -> bytes:
    """The small model with another threshold, or for another camera."""
    run = small_run()
    camera = replace(trained_camera(run, "run"), width=width)
    return export_run(Run(run.net, run.config, {**run.info, "threshold": threshold}), camera).content()


def predict_until(model: HotReloadedModel, done) -> int:
    """Predict frame by frame; the number of predictions until `done()`, all of which were right."""
    frame = toy_frames()[0]
    for count in range(1, 2000):
        found = model.predict(frame.image, frame.up_cam)
        assert np.isfinite(found.entropy).all()
        small = found.entropy > model.threshold
        assert (small.mean() > 0) == bool(found.obstacles.any()) or small.sum() < 5
        if done():
            return count
        time.sleep(0.002)
    raise AssertionError("never happened")


def test_a_fresh_file_is_taken_over_between_two_frames(tmp_path):
    path = tmp_path / "model.onnx"
    path.write_bytes(small_export().content())
    model = HotReloadedModel.load(path)
    first = model.threshold
    predict_until(model, lambda: True)
    for number, threshold in enumerate((0.31, 0.62), 1):
        write_bytes(path, other_export(threshold))
        predict_until(model, lambda number=number: model.taken_over == number)
        assert model.threshold == pytest.approx(threshold) != first
    assert model.summary() == {"taken_over": 2, "refused": 0, "problem": None}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (lambda: small_export().content()[:-50], "is cut off"),
        (lambda: b"nothing", "is no obstacle model"),
        (lambda: other_export(0.4, width=128), "another camera"),
    ],
)
def test_a_file_that_does_not_fit_is_refused_and_the_old_one_flies_on(tmp_path, content, words):
    path = tmp_path / "model.onnx"
    path.write_bytes(small_export().content())
    model = HotReloadedModel.load(path)
    before = model.current.sha256
    write_bytes(path, content())
    predict_until(model, lambda: model.refused == 1)
    assert words in str(model.problem)
    assert model.current.sha256 == before
    path.unlink()
    predict_until(model, lambda: True)
    write_bytes(path, other_export(0.31))
    predict_until(model, lambda: model.taken_over == 1)


def test_fly_takes_over_a_model_in_flight_and_drops_no_frame(tmp_path):
    path, out = tmp_path / "model.onnx", tmp_path / "figures.json"
    path.write_bytes(small_export().content())
    fresh = other_export(0.31)
    parser = argparse.ArgumentParser()
    fly.add_arguments(parser)
    arguments = [str(path), "--source", str(toy_set()), "--mavlink", "udpout:127.0.0.1:9", "--out", str(out)]
    timer = threading.Timer(0.8, write_bytes, (path, fresh))
    timer.start()
    fly.run(parser.parse_args(arguments))
    timer.join()
    figures = json.loads(out.read_text())
    assert figures["model"]["taken_over"] == 1
    # 24 frames at 10 Hz: every one was looked at, the hand-over among them.
    assert figures["pictures"]["seen"] == figures["pictures"]["looked_at"] == 24
    assert figures["pictures"]["skipped"] == 0


def test_a_model_written_by_the_learner_is_taken_over_while_it_learns(toy, tmp_path):
    out = tmp_path / "run"
    run = tiny_run(toy, out, export_every_s=1e-3)
    run.run()
    run.finish()
    model = HotReloadedModel.load(out / "model.onnx")
    again = tiny_run(toy, out, restart=True, export_every_s=1e-3)
    learner = threading.Thread(target=lambda: (again.run(), again.finish()))
    learner.start()
    one = open_recording(toy).read(0)
    predictions, end_s = 0, time.monotonic() + 300
    while learner.is_alive() or model.taken_over == 0:
        assert time.monotonic() < end_s, model.problem
        assert np.isfinite(model.predict(one.image, one.up_cam).entropy).all()
        predictions += 1
        time.sleep(0.002)
    learner.join()
    assert predictions > 20
    # The first ones have hardly learned: they are refused with the reason, and the old one flies on.
    assert model.refused == 0 or "has learned too little" in str(model.problem)
    assert model.taken_over >= 1
