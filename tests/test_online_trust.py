"""Bad streams: what must not be learned from is found, what is good is not refused."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from scipy.spatial.transform import Rotation
from tiny_online import frame_lines, tiny_options
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError
from horizon_dl.evidence.exposure import exposure_problem
from horizon_dl.evidence.motion import contradicts, tilt_between, turn_rad, turned_sketch
from horizon_dl.evidence.sketch import difference, same_picture, sketch_of
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.online.guard import Distrust, StreamGuard
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.checkpoint import Snapshot

CAMERA = Camera("pinhole", 96, 72, 80.0, 80.0, 47.5, 35.5)
LEVEL = np.array([0.0, -1.0, 0.0])


def world_image(pitch_rad: float, seed: int = 0, camera: Camera = CAMERA) -> np.ndarray:
    """What a camera pitched up sees of a smooth random sphere."""
    rng = np.random.default_rng(seed)
    waves = rng.normal(size=(12, 3)) * 6
    phases = rng.uniform(0, 2 * np.pi, 12)
    world = Rotation.from_euler("x", pitch_rad).apply(camera_rays(camera).directions.reshape(-1, 3))
    grey = np.sin(world @ waves.T + phases).sum(axis=1).reshape(camera.height, camera.width)
    noise = rng.normal(0, 4, grey.shape)
    return np.repeat((128 + 25 * grey + noise).clip(0, 255).astype(np.uint8)[..., None], 3, axis=2)


def up_of(pitch_rad: float) -> np.ndarray:
    return Rotation.from_euler("x", -pitch_rad).apply(LEVEL)


def frame_at(index: int, pitch_rad: float, seen_rad: float | None = None, **changes) -> Frame:
    """A frame whose picture is that of `seen_rad` (of its attitude where left out)."""
    image = world_image(pitch_rad if seen_rad is None else seen_rad)
    rng = np.random.default_rng(index)
    image = (image + rng.normal(0, 3, image.shape)).clip(0, 255).astype(np.uint8)
    frame = Frame(str(index), index / 10, up_of(pitch_rad), image=image, camera=CAMERA)
    return replace(frame, **changes)


def reasons(frames: list[Frame]) -> list[Distrust | None]:
    guard = StreamGuard()
    return [guard.check(frame) for frame in frames]


def swaying(count: int = 12) -> list[Frame]:
    return [frame_at(index, 0.2 * math.sin(index)) for index in range(count)]


def test_a_good_stream_is_trusted():
    assert reasons(swaying()) == [None] * 12


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"up_cam": None}, Distrust.NO_ATTITUDE),
        ({"up_cam": np.full(3, np.nan)}, Distrust.NO_ATTITUDE),
        ({"up_cam": np.array([0.0, -2.0, 0.0])}, Distrust.NO_ATTITUDE),
        ({"image": np.zeros((72, 96, 3), np.uint8)}, Distrust.DARK),
        ({"image": np.full((72, 96, 3), 255, np.uint8)}, Distrust.BRIGHT),
        ({"image": np.full((72, 96, 3), 90, np.uint8)}, Distrust.FLAT),
        ({"image": np.zeros((36, 48, 3), np.uint8)}, Distrust.SIZE),
        ({"time_s": 0.1}, Distrust.CLOCK),
        ({"time_s": 0.4}, Distrust.CLOCK),
        ({"time_s": math.nan}, Distrust.CLOCK),
    ],
)
def test_one_bad_frame_is_refused_and_no_other(changes, reason):
    frames = swaying()
    frames[5] = replace(frames[5], **changes)
    found = reasons(frames)
    assert found[5] is reason
    others = found[:5] + found[6:]
    assert set(others) <= {None}


def test_a_clock_that_was_set_back_is_believed_from_then_on():
    frames = [
        replace(frame, time_s=frame.time_s - (100 if i >= 6 else 0)) for i, frame in enumerate(swaying())
    ]
    assert reasons(frames) == [None] * 6 + [Distrust.CLOCK] + [None] * 5


def test_a_frozen_picture_is_refused_while_the_attitude_moves():
    frames = swaying(14)
    stuck = [replace(frame, image=frames[3].image) if 3 <= i < 9 else frame for i, frame in enumerate(frames)]
    assert reasons(stuck) == [None] * 4 + [Distrust.FROZEN] * 5 + [None] * 5


def test_a_picture_that_stands_with_its_camera_is_no_fault():
    still = [replace(frame_at(0, 0.1), time_s=index / 10) for index in range(5)]
    assert reasons(still) == [None] * 5


@pytest.mark.parametrize("jump_deg", [6, 10, 20, 45, 120])
def test_an_attitude_that_jumps_while_the_picture_does_not_is_refused(jump_deg):
    jump = math.radians(jump_deg)
    frames = [frame_at(i, 0.05 * i + (jump if i == 5 else 0.0), 0.05 * i) for i in range(10)]
    assert reasons(frames) == [None] * 5 + [Distrust.JUMP] + [None] * 4


@pytest.mark.parametrize("turn_deg", [6, 12, 25])
def test_a_camera_that_really_turns_fast_is_trusted(turn_deg):
    turn = math.radians(turn_deg)
    assert reasons([frame_at(i, turn if i >= 5 else 0.0) for i in range(10)]) == [None] * 10


def test_a_jump_that_stays_is_believed_after_half_a_second():
    frames = [frame_at(i, 0.3 if i >= 4 else 0.0, 0.0) for i in range(16)]
    found = reasons(frames)
    assert found[4:9] == [Distrust.JUMP] * 5
    assert found[10:] == [None] * 6


def test_the_guard_goes_on_from_its_snapshot():
    frames = [frame_at(i, 0.05 * i + (0.3 if i in (4, 7) else 0.0), 0.05 * i) for i in range(12)]
    frames[9] = replace(frames[9], time_s=math.nan)
    for stop in range(12):
        guard = StreamGuard()
        before = [guard.check(frame) for frame in frames[:stop]]
        restored = StreamGuard()
        snapshot = guard.snapshot()
        restored.restore(Snapshot(snapshot.tensors, json.loads(json.dumps(snapshot.values, allow_nan=False))))
        assert before + [restored.check(frame) for frame in frames[stop:]] == reasons(frames)


angles = st.floats(-1.2, 1.2)


@given(angles, angles, angles, angles)
def test_the_tilt_is_the_shortest_rotation(a, b, c, d):
    one, other = (Rotation.from_euler("xz", pair).apply(LEVEL) for pair in ((a, b), (c, d)))
    tilt = tilt_between(one, other)
    assert tilt @ one == pytest.approx(other, abs=1e-9)
    assert tilt @ tilt.T == pytest.approx(np.eye(3), abs=1e-9)
    assert Rotation.from_matrix(tilt).magnitude() == pytest.approx(turn_rad(one, other), abs=1e-6)


@pytest.mark.parametrize(
    "camera",
    [CAMERA, Camera("radtan", 96, 72, 80.0, 80.0, 47.5, 35.5, (-0.2, 0.03, 0.001, 0.0, 0.0))],
)
def test_a_turned_sketch_is_what_the_turned_camera_sees(camera):
    before, now = (sketch_of(world_image(pitch, camera=camera)) for pitch in (0.0, 0.15))
    turned = turned_sketch(camera, before, tilt_between(up_of(0.0), up_of(0.15)))
    known = ~np.isnan(turned)
    assert 0.5 < known.mean() < 1.0
    assert difference(turned[known], now[known]) < 0.4 * difference(before[known], now[known])
    assert not contradicts(camera, before, now, up_of(0.0), up_of(0.15))
    assert contradicts(camera, before, before, up_of(0.0), up_of(0.15))


def test_sketches():
    image = world_image(0.0)
    assert sketch_of(image).shape == (48, 64)
    assert exposure_problem(sketch_of(image)) is None
    rng = np.random.default_rng(0)
    noisy = (image + rng.normal(0, 2, image.shape)).clip(0, 255).astype(np.uint8)
    assert same_picture(sketch_of(image), sketch_of(image.copy()))
    assert not same_picture(sketch_of(image), sketch_of(noisy))
    assert sketch_of(image[:5, :7]).shape == (5, 7)


@pytest.mark.real_data
@pytest.mark.parametrize("name", ["arena", "corridor", "hallway", "kitti", "tum_sample", "euroc_sample"])
def test_hardly_a_frame_of_a_real_recording_is_refused(data_dir, name):
    recording = open_recording(data_dir / name)
    with_attitude = [i for i, entry in enumerate(recording.headers) if entry.up_cam is not None]
    for step in (1, 5):  # 5: KITTI at 2 Hz
        found = reasons([recording.read(i) for i in with_attitude[::step]])
        assert sum(reason is not None for reason in found) <= len(found) // 100


@pytest.fixture
def corrupted(tmp_path):
    """The toy set with one kind of damage every few frames; the reasons expected, by index."""
    folder = write_toy_set(tmp_path / "set", frames=40)
    head, *rows = (folder / "frames.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]

    def image(index: int):
        return folder / cells[index][0]

    cells[4][3] = "nan"
    Image.new("RGB", (96, 72)).save(image(8))
    Image.new("RGB", (96, 72), "white").save(image(12))
    Image.open(image(16)).resize((48, 36)).save(image(16))
    image(20).write_bytes(image(20).read_bytes()[:200])
    image(26).write_bytes(image(25).read_bytes())
    cells[28][3] = str(float(cells[28][3]) + 0.4)
    cells[32][1] = cells[31][1]
    (folder / "labels" / "036.png").write_bytes(b"no image")
    (folder / "frames.csv").write_text("\n".join([head, *(",".join(row) for row in cells)]) + "\n")
    expected = {
        4: "no attitude",
        8: "black",
        12: "overexposed",
        16: "resolution changed",
        20: "unreadable",
        26: "image frozen",
        28: "attitude jumped",
        32: "clock not advancing",
    }
    return folder, expected


def test_a_corrupted_set_is_predicted_as_far_as_it_can_be(corrupted, tmp_path, capsys):
    folder, expected = corrupted
    with pytest.raises(FrameError):
        open_recording(folder).read(16)
    out = tmp_path / "run"
    assert main(["online", str(folder), "--out", str(out), *tiny_options()]) == 0
    found = {line["index"]: line["not_learned"] for line in frame_lines(out) if line["not_learned"]}
    assert found == expected
    info = json.loads((out / "run.json").read_text())["online"]
    assert info["not_learned"] == dict.fromkeys(expected.values(), 1)
    assert (info["seen"], info["predicted"], info["learned"]) == (40, 39, 32)
    said = capsys.readouterr().out
    assert all(f"not learned from: 1, {reason}" in said for reason in expected.values())
    # Frames 26, 28 and 32 have no horizon to score against, 20 no image, 36 no truth that can be read.
    assert json.loads((out / "metrics.json").read_text())["frames"]["test"] == 15


def test_a_stream_with_nothing_to_learn_from_is_one_line(tmp_path, capsys):
    folder = write_toy_set(tmp_path / "set", frames=6)
    for path in (folder / "images").iterdir():
        Image.new("RGB", (96, 72)).save(path)
    arguments = ["online", str(folder), "--out", str(tmp_path / "run"), *tiny_options()]
    assert main(arguments) == 2
    assert "almost all images are too dark" in capsys.readouterr().err
    assert main([*arguments, "--force"]) == 2
    assert "has no frame to learn from (black: 6)" in capsys.readouterr().err
