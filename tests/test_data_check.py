import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import FrameHeader
from horizon_dl.errors import InputError
from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.inspection.data_check import check_recording, sample_indices
from horizon_dl.inspection.finding import Finding, verdict_of
from horizon_dl.inspection.findings import percent
from horizon_dl.inspection.timing_and_attitude import attitudes, camera_angles_deg, timing
from horizon_dl.readers.registry import open_recording
from horizon_dl.reporting.check import check_lines, write_check

WIDTH, HEIGHT, FOCAL = 96, 72, 80.0
CAMERA = f"""model: pinhole
width: {WIDTH}
height: {HEIGHT}
fx: {FOCAL}
fy: {FOCAL}
cx: 47.5
cy: 35.5
distortion: []
mount_rpy_deg: [0.0, 0.0, 0.0]
"""


def world(seed: int = 0) -> NDArray[np.uint8]:
    """A panorama, a pixel a half degree: rows from +90 to -90 degrees elevation, columns of azimuth."""
    noise = np.random.default_rng(seed).integers(0, 90, (91, 180, 3)).astype(np.uint8)
    picture = np.asarray(Image.fromarray(noise).resize((720, 361), Image.Resampling.BICUBIC)).astype(int)
    picture[:180] += [20, 60, 150]
    picture[180:] += [40, 120, 30]
    return picture.clip(0, 255).astype(np.uint8)


def photo(scene: NDArray[np.uint8], roll: float, pitch: float) -> NDArray[np.uint8]:
    """What the camera sees, by its own geometry: rotate rays by roll about the axis, then pitch."""
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    right, down = (u - 47.5) / FOCAL, (v - 35.5) / FOCAL
    right, down = (
        right * math.cos(roll) - down * math.sin(roll),
        right * math.sin(roll) + down * math.cos(roll),
    )
    forward, up = math.cos(pitch) + down * math.sin(pitch), math.sin(pitch) - down * math.cos(pitch)
    elevation = np.rad2deg(np.arctan2(up, np.hypot(forward, right)))
    azimuth = np.rad2deg(np.arctan2(right, forward)) % 360
    return scene[((90 - elevation) * 2).round().astype(int), (azimuth * 2).astype(int) % 720]


def write_set(
    folder: Path,
    pitches: Sequence[float],
    rolls: Sequence[float],
    *,
    times: Sequence[float] | None = None,
    logged_pitches: Sequence[float] | None = None,
    pictures: Sequence[NDArray[np.uint8]] | None = None,
    height: str = "1.0",
) -> Path:
    (folder / "images").mkdir(parents=True)
    scene = world()
    lines = ["image,time_s,roll_rad,pitch_rad,yaw_rad,height_m"]
    for index, (pitch, roll) in enumerate(zip(pitches, rolls, strict=True)):
        name = f"images/{index:04d}.png"
        image = photo(scene, roll, pitch) if pictures is None else pictures[index]
        Image.fromarray(image).save(folder / name)
        time_s = index * 0.1 if times is None else times[index]
        logged = pitch if logged_pitches is None else logged_pitches[index]
        lines.append(f"{name},{time_s:.3f},{roll},{logged},0,{height}")
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    (folder / "camera.yaml").write_text(CAMERA)
    return folder


def swing(count: int, seed: int = 1) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pitches and rolls in rad that change from frame to frame without a period."""
    chance = np.random.default_rng(seed)
    return chance.uniform(-0.09, 0.09, count), chance.uniform(-0.07, 0.07, count)


def checked(folder: Path, **options: int) -> DataCheck:
    return check_recording(open_recording(folder), **options)


def levels(check: DataCheck, words: str) -> list[str]:
    return [finding.level for finding in check.findings if words in finding.text]


@pytest.fixture(scope="module")
def good_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_set(tmp_path_factory.mktemp("sets") / "good", *swing(60))


def test_good_set_can_work(good_set: Path) -> None:
    check = checked(good_set)
    assert (check.level, check.verdict) == ("ok", "This data can work.")
    assert {finding.level for finding in check.findings} == {"ok"}
    assert check.labels is not None
    assert check.labels.visible_share == 1.0
    assert check.labels.above + check.labels.below + check.labels.ignored == pytest.approx(1.0)
    assert check.timing.rate_hz == pytest.approx(10.0)
    assert check.height_m is not None
    assert check.height_m.p50 == 1.0
    assert check.motion is not None
    assert check.motion.correlation > 0.9


def test_attitude_range_is_the_cameras_own(good_set: Path) -> None:
    pitches, rolls = swing(60)
    found = checked(good_set).attitudes
    assert found is not None
    assert found.pitch_deg.p95 == pytest.approx(np.rad2deg(np.percentile(pitches, 95)), abs=1e-4)
    assert found.roll_deg.p5 == pytest.approx(np.rad2deg(np.percentile(rolls, 5)), abs=1e-4)


def test_camera_angles_of_hand_made_cases() -> None:
    """Level; right side 30 degrees down; axis 20 degrees up; upside down."""
    half = math.sqrt(3) / 2
    sine, cosine = math.sin(math.radians(20)), math.cos(math.radians(20))
    roll, pitch = camera_angles_deg(np.array([[0, -1, 0], [-0.5, -half, 0], [0, -cosine, sine], [0, 1, 0.0]]))
    np.testing.assert_allclose(roll, [0, 30, 0, 180], atol=1e-9)
    np.testing.assert_allclose(pitch, [0, 0, 20, 0], atol=1e-9)


def test_few_frames_work_poorly(tmp_path: Path) -> None:
    check = checked(write_set(tmp_path / "few", *swing(12)))
    assert check.level == "warning"
    expected = "This data will probably work poorly because there are too few frames to train well (12)."
    assert check.verdict == expected


def test_camera_at_the_ceiling_cannot_work(tmp_path: Path) -> None:
    pitches, rolls = swing(60)
    check = checked(write_set(tmp_path / "ceiling", pitches + 1.2, rolls))
    assert check.level == "problem"
    assert (
        "cannot work because the horizon is almost never in the image, only what lies above it"
        in check.verdict
    )


def test_unbalanced_labels(tmp_path: Path) -> None:
    """Axis 22 degrees up, vertical field 48 degrees: a sliver of floor stays."""
    check = checked(
        write_set(
            tmp_path / "up",
            *(angle * 0.1 + shift for angle, shift in zip(swing(60), (0.385, 0), strict=True)),
        )
    )
    assert "almost nothing below the horizon is seen" in check.verdict


def test_horizon_that_stands_still_warns(tmp_path: Path) -> None:
    pitches, rolls = swing(60)
    check = checked(write_set(tmp_path / "still", pitches * 0.02, rolls * 0.02))
    assert levels(check, "the row in place of the looks") == ["warning"]
    assert check.level == "ok"
    assert check.verdict == "This data can work; mind the warning."


def test_constant_attitude_warns(tmp_path: Path) -> None:
    pitches, rolls = swing(60)
    check = checked(write_set(tmp_path / "constant", pitches * 0, rolls * 0))
    assert levels(check, "The attitude is the same in all frames") == ["warning"]


def test_clocks_apart_are_found_with_sign_and_size(tmp_path: Path) -> None:
    """The image of 0.2 s after the log's: the log's attitude comes two frames too late."""
    pitches, rolls = swing(80)
    scene = world()
    pictures = [photo(scene, rolls[(i + 2) % 80], pitches[(i + 2) % 80]) for i in range(80)]
    check = checked(write_set(tmp_path / "late", pitches, rolls, pictures=pictures))
    assert check.motion is not None
    assert check.motion.best_lag_s == pytest.approx(0.2)
    assert "do not belong to the same time" in check.verdict
    assert any("add 0.20 s to the images' times" in finding.hint for finding in check.findings)


def test_wrong_sign_of_pitch_is_found(tmp_path: Path) -> None:
    pitches, rolls = swing(60)
    check = checked(write_set(tmp_path / "flipped", pitches, rolls, logged_pitches=-pitches))
    assert "the images move against the attitude's pitch" in check.verdict


def test_log_of_another_flight_warns(tmp_path: Path) -> None:
    (pitches, rolls), (others, other_rolls) = swing(80), swing(80, seed=9)
    scene = world()
    pictures = [photo(scene, roll, pitch) for pitch, roll in zip(others, other_rolls, strict=True)]
    check = checked(write_set(tmp_path / "other", pitches, rolls, pictures=pictures))
    assert levels(check, "The images do not move as the attitude says") == ["warning"]


def test_time_gap_and_doubled_times(tmp_path: Path) -> None:
    times = [index * 0.1 + (3.0 if index > 20 else 0.0) for index in range(60)]
    times[31] = times[30]
    check = checked(write_set(tmp_path / "gap", *swing(60), times=times))
    assert levels(check, "1 time gap, the longest of 3.1 s after images/0020.png") == ["warning"]
    assert levels(check, "1 frame has the same time as the frame before") == ["warning"]


def test_clock_set_back_shows_in_the_names() -> None:
    times = [*np.arange(30) * 0.1, *(np.arange(30) * 0.1 + 0.55)]
    entries = [FrameHeader(f"i/{n}.png", t) for n, t in enumerate(times)]
    assert timing(sorted(entries, key=lambda entry: entry.time_s)).backwards == 1
    shuffled = np.random.default_rng(0).permutation(60)
    named_at_random = [replace(entry, name=f"i/{k}.png") for entry, k in zip(entries, shuffled, strict=True)]
    assert timing(sorted(named_at_random, key=lambda entry: entry.time_s)).backwards == 0
    assert timing([*entries[5:10], entries[0]]).backwards == 1


def test_missing_attitudes_are_counted(good_set: Path) -> None:
    recording = open_recording(good_set)
    some = [replace(entry, up_cam=None) if n % 3 else entry for n, entry in enumerate(recording.headers)]
    check = check_recording(replace(recording, headers=some))
    assert check.attitudes is not None
    assert check.attitudes.missing == 40
    assert "most frames have no attitude" in check.verdict
    none = [replace(entry, up_cam=None) for entry in recording.headers]
    check = check_recording(replace(recording, headers=none))
    assert check.verdict == "This data cannot work because no frame has an attitude."
    assert attitudes(none) is None


def test_unreadable_images_are_skipped_and_named(tmp_path: Path) -> None:
    folder = write_set(tmp_path / "torn", *swing(60))
    for index in (3, 4):
        path = folder / f"images/{index:04d}.png"
        path.write_bytes(path.read_bytes()[:300])
    check = checked(folder)
    assert check.unreadable == 2
    assert check.unreadable_examples[0][0] == "images/0003.png"
    assert levels(check, "2 of 60 images looked at cannot be read") == ["warning"]
    assert check.level == "ok"
    for path in (folder / "images").glob("*.png"):
        path.write_bytes(b"no image")
    check = checked(folder)
    assert check.level == "problem"
    assert "most images cannot be read" in check.verdict


@pytest.mark.parametrize(
    ("level", "words"), [(4, "almost all images are too dark"), (254, "almost all images are overexposed")]
)
def test_exposure(tmp_path: Path, level: int, words: str) -> None:
    chance = np.random.default_rng(0)
    pictures = [
        np.clip(level + chance.integers(-3, 4, (HEIGHT, WIDTH, 3)), 0, 255).astype(np.uint8)
        for _ in range(60)
    ]
    check = checked(write_set(tmp_path / "light", *swing(60), pictures=pictures))
    assert check.level == "problem"
    assert words in check.verdict


def test_frozen_camera(tmp_path: Path) -> None:
    check = checked(write_set(tmp_path / "frozen", *swing(60), pictures=[photo(world(), 0, 0)] * 60))
    assert check.level == "problem"
    assert "almost all images are the same as the one before" in check.verdict


def test_floor_labelled_above_the_horizon_warns(tmp_path: Path) -> None:
    folder = write_set(tmp_path / "labelled", *swing(60))
    (folder / "labels").mkdir()
    truth = np.full((HEIGHT, WIDTH), 3, np.uint8)
    truth[20:] = 1
    Image.fromarray(truth).save(folder / "labels/0007.png")
    check = checked(folder)
    assert check.truth is not None
    assert (check.truth.labelled_frames, check.truth.read_frames) == (1, 1)
    assert check.truth.floor == pytest.approx(52 / 72)
    assert "the horizon lies too low on the labelled floor" in check.verdict


def test_camera_on_its_side(tmp_path: Path) -> None:
    pitches, rolls = swing(60)
    check = checked(write_set(tmp_path / "side", pitches, rolls + math.pi / 2))
    assert "the camera is rolled by" in check.verdict
    assert any("rotate_image" in finding.hint for finding in check.findings)


def test_no_frames_is_an_input_error(good_set: Path) -> None:
    with pytest.raises(InputError, match="has no frames"):
        check_recording(replace(open_recording(good_set), headers=[]))


def test_sampling_takes_pairs_of_neighbours() -> None:
    indices = sample_indices(1000, 20)
    assert len(indices) == 20
    assert indices[0] == 0
    assert indices[-1] == 999
    assert all(b - a == 1 for a, b in zip(indices[::2], indices[1::2], strict=True))
    assert sample_indices(1, 200) == [0]


def test_written_check(good_set: Path, tmp_path: Path) -> None:
    check = checked(good_set, max_frames=20)
    write_check(check, tmp_path)
    stored = json.loads((tmp_path / "check.json").read_text())
    assert stored["verdict"] == check.verdict
    assert stored["labels"]["visible_share"] == 1.0
    assert "overlay_views" not in stored
    overlays = sorted((tmp_path / "overlays").iterdir())
    assert len(overlays) == 8
    assert Image.open(overlays[0]).size == (640, 480)
    page = (tmp_path / "index.html").read_text()
    assert check.verdict in page
    assert page.count("data:image/jpeg;base64,") == 8
    assert not list(tmp_path.glob("**/*.part"))


def test_lines_fit_a_console(good_set: Path) -> None:
    lines = check_lines(checked(good_set, max_frames=20))
    assert lines[1] == "This data can work."
    assert max(map(len, lines)) <= 100


def test_verdict_joins_reasons() -> None:
    findings = [
        Finding("warning", "A.", reason="a"),
        Finding("warning", "B.", reason="b"),
        Finding("ok", "C."),
    ]
    assert verdict_of(findings) == ("warning", "This data will probably work poorly because a and b.")
    worse = [*findings, Finding("problem", "D.", reason="d")]
    assert verdict_of(worse) == ("problem", "This data cannot work because d.")


@pytest.mark.parametrize(
    ("share", "text"), [(0.0, "0 %"), (1e-6, "0.1 %"), (0.9999, "99.9 %"), (0.034, "3.4 %"), (1.0, "100 %")]
)
def test_percent(share: float, text: str) -> None:
    assert percent(share) == text


@pytest.mark.real_data
@pytest.mark.parametrize(
    ("name", "level", "words"),
    [
        ("hallway", "ok", "can work"),
        ("arena", "ok", "can work"),
        ("corridor", "ok", "can work"),
        ("kitti/2011_09_26/2011_09_26_drive_0052_sync", "ok", "can work; mind the warning"),
        ("tum_sample", "warning", "too few frames to train well"),
        ("euroc_sample", "warning", "too few frames to train well"),
    ],
)
def test_real_sets(data_dir: Path, name: str, level: str, words: str) -> None:
    check = check_recording(open_recording(data_dir / name), max_frames=120)
    assert check.level == level
    assert words in check.verdict
    assert check.unreadable == 0
    assert check.labels is not None
    assert check.labels.visible_share > 0.9
    if check.truth is not None:
        assert check.truth.floor_above_horizon < 0.02


@pytest.mark.real_data
@pytest.mark.parametrize("name", ["hallway", "arena", "corridor"])
def test_shifted_clock_of_real_sets_is_found(data_dir: Path, name: str) -> None:
    recording = open_recording(data_dir / name)
    ups = [entry.up_cam for entry in recording.headers]
    late = [replace(entry, up_cam=ups[max(n - 2, 0)]) for n, entry in enumerate(recording.headers)]
    assert not levels(check_recording(recording, max_frames=120), "The images move as the attitude of")
    check = check_recording(replace(recording, headers=late), max_frames=120)
    assert check.motion is not None
    assert check.timing.rate_hz is not None
    assert check.motion.best_lag_s == pytest.approx(2 / check.timing.rate_hz)
    assert "do not belong to the same time" in check.verdict
