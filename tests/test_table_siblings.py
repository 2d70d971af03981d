"""Tables and folders a little other than those that are read, as apps write them: right, or told."""

import gzip
import math
import unicodedata
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from horizon_dl.cli import main
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import Given
from horizon_dl.data.picture_times import picture_times
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.csv_table import read as read_table_log
from horizon_dl.readers.registry import open_recording

CAMERA = "model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n"
TIMES = np.arange(0.0, 3.0, 0.1)
ROLL_DEG, PITCH_DEG = 8.0 * np.sin(2 * TIMES), -15.0 + 5.0 * np.cos(3 * TIMES)
BODY_DEG = 20.0 * np.sin(TIMES)


def table(path: Path, names: str, *columns: np.ndarray) -> Path:
    rows = [",".join(f"{value:.9g}" for value in row) for row in np.column_stack(columns)]
    path.write_text("\n".join([names, *rows]) + "\n")
    return path


def quaternions(roll_deg: np.ndarray, pitch_deg: np.ndarray) -> np.ndarray:
    """(N, 4) w, x, y, z of roll after pitch, by half angles."""
    a, b = np.radians(roll_deg) / 2, np.radians(pitch_deg) / 2
    return np.stack(
        [np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.cos(a) * np.sin(b), -np.sin(a) * np.sin(b)], axis=-1
    )


def angles_deg(path: Path, **given: str) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    log = read_table_log(path, Given(**given))  # type: ignore[arg-type]
    w, x, y, z = log.quaternions.T
    roll = np.degrees(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)))
    return roll, np.degrees(np.arcsin(2 * (w * y - z * x))), log.notes


@pytest.mark.parametrize(
    ("body", "camera"),
    [
        ("pitch(degrees),roll(degrees)", "gimbal_pitch(degrees),gimbal_roll(degrees)"),
        ("pitch(deg),roll(deg)", "gimbalPitch(deg),gimbalRoll(deg)"),
        ("pitch_deg,roll_deg", "camera_pitch_deg,camera_roll_deg"),
        ("OSD.pitch,OSD.roll", "GIMBAL.pitch,GIMBAL.roll"),
    ],
)
def test_the_camera_hangs_on_its_gimbal(tmp_path: Path, body: str, camera: str) -> None:
    path = table(
        tmp_path / "l.csv", f"time_s,{body},{camera}", TIMES, BODY_DEG, -BODY_DEG, PITCH_DEG, ROLL_DEG
    )
    roll, pitch, notes = angles_deg(path)
    assert np.allclose(roll, ROLL_DEG, atol=1e-4)
    assert np.allclose(pitch, PITCH_DEG, atol=1e-4)
    told = [note for note in notes if isinstance(note, Doubt) and "gimbal's" in note]
    assert len(told) == (not body.startswith("OSD"))  # no vehicle's column was found there


def test_a_gimbals_quaternion_is_taken(tmp_path: Path) -> None:
    names = [f"{who}_quat_{axis}" for who in ("drone", "frame") for axis in "wxyz"]
    both = [*quaternions(BODY_DEG, BODY_DEG).T, *quaternions(ROLL_DEG, PITCH_DEG).T]
    roll, pitch, _ = angles_deg(table(tmp_path / "l.csv", ",".join(["time", *names]), TIMES, *both))
    assert np.allclose(roll, ROLL_DEG, atol=1e-4)
    assert np.allclose(pitch, PITCH_DEG, atol=1e-4)


@pytest.mark.parametrize(
    ("prefix", "angle"), [("gimbal", 0.0), ("camera", -15.0)], ids=["an unused gimbal", "a mount's angle"]
)
def test_a_vehicles_attitude_stays_where_the_cameras_tells_nothing(
    tmp_path: Path, prefix: str, angle: float
) -> None:
    names = f"time_s,roll_deg,pitch_deg,{prefix}_roll_deg,{prefix}_pitch_deg"
    still = np.full(len(TIMES), angle)
    roll, _, notes = angles_deg(
        table(tmp_path / "l.csv", names, TIMES, ROLL_DEG, PITCH_DEG, 0 * still, still)
    )
    assert np.allclose(roll, ROLL_DEG, atol=1e-4)
    assert not any(isinstance(note, Doubt) for note in notes)


def test_radians_beside_a_heading_in_degrees(tmp_path: Path) -> None:
    columns = np.radians(ROLL_DEG), np.radians(PITCH_DEG), 200.0 + 50.0 * TIMES
    path = table(tmp_path / "l.csv", "time,roll,pitch,heading", TIMES, *columns)
    with pytest.raises(InputError, match="heading is in degrees") as refused:
        angles_deg(path)
    assert "--angle-unit rad" in str(refused.value)
    roll, _, _ = angles_deg(path, angle_unit="rad")
    assert np.allclose(roll, ROLL_DEG, atol=1e-4)
    yaw = read_table_log(path, Given(angle_unit="rad")).quaternions
    assert np.isfinite(yaw).all()


def named(*stems: str) -> list[Path]:
    return [Path(f"{stem}.png") for stem in stems]


@pytest.mark.parametrize(
    ("stems", "steps_s"),
    [
        (("1714570000_950000000", "1714570001_050000000", "1714570001_170000000"), (0.1, 0.12)),
        (("1714570000-950", "1714570001-050"), (0.1,)),
        (("1714570000.950000", "1714570001.050000"), (0.1,)),
        (("1714570000950_cam0", "1714570001050_cam0"), (0.1,)),
        (("20240501_125959_950", "20240501_130000_050"), (0.1,)),
        (("PXL_20240501_125959950", "PXL_20240501_130000050"), (0.1,)),
        (("2024-05-01T12-59-59.950", "2024-05-01T13-00-00.050"), (0.1,)),
        (("IMG_20240501_125950", "IMG_20240501_130010"), (20.0,)),
        (("left_100033333", "left_100066666"), (0.033333,)),
    ],
)
def test_times_in_the_names_of_pictures(stems: tuple[str, ...], steps_s: tuple[float, ...]) -> None:
    times_s = picture_times(named(*stems))
    assert times_s is not None
    assert np.allclose(np.diff(times_s), steps_s, atol=1e-6)


@pytest.mark.parametrize(
    "stems",
    [
        ("frame_0000", "frame_0030", "frame_0060", "frame_0090"),
        ("000001", "000002", "000003"),
        ("IMG_20240501_130000", "IMG_20240501_130000", "IMG_20240501_130001"),
        ("20240501_130000_1", "20240501_130000_2_b", "no number"),
        ("99999999_250000", "99999999_250001"),
    ],
)
def test_names_that_tell_no_times(stems: tuple[str, ...]) -> None:
    assert picture_times(named(*stems)) is None


def pictures(folder: Path, names: list[str]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        Image.fromarray(np.full((24, 32, 3), 90, np.uint8)).save(folder / name)
    (folder.parent / "camera.yaml").write_text(CAMERA)
    return folder


def stamped(folder: Path, start_s: float = 1714570000.0) -> Path:
    return pictures(folder, [f"{round((start_s + time_s) * 1e3)}.png" for time_s in TIMES])


def log_of(path: Path, start_s: float = 1714570000.0) -> Path:
    times_s = np.arange(-0.2, 3.3, 0.02)
    rows = [f"{start_s + time_s:.3f},{8.0 * math.sin(2 * time_s):.6f},-15.0" for time_s in times_s]
    path.write_text("\n".join(["time,roll_deg,pitch_deg", *rows]) + "\n")
    return path


def given(folder: Path, log: Path, **more: object) -> Given:
    return Given(camera=folder.parent / "camera.yaml", attitude=str(log), **more)  # type: ignore[arg-type]


def test_pictures_beside_a_log_may_be_read_by_another_convention(tmp_path: Path) -> None:
    folder, log = stamped(tmp_path / "imgs"), log_of(tmp_path / "log.csv")
    plain = open_recording(folder, given=given(folder, log))
    turned = open_recording(folder, given=given(folder, log, convention="flu z-up"))
    assert plain.reading is not None
    assert not np.allclose(plain.headers[9].up_cam, turned.headers[9].up_cam)


@pytest.mark.parametrize("with_table", [False, True])
def test_pictures_on_another_clock_are_opened_for_it_to_be_found(tmp_path: Path, with_table: bool) -> None:
    folder, log = stamped(tmp_path / "set" / "images"), log_of(tmp_path / "log.csv", start_s=50.0)
    source = folder
    if with_table:
        source = folder.parent
        rows = [f"images/{path.name},{int(path.stem) * 1e-3:.3f}" for path in sorted(folder.iterdir())]
        (source / "frames.csv").write_text("\n".join(["image,time_s", *rows]) + "\n")
    with pytest.raises(InputError, match="never meet"):
        open_recording(source, given=given(folder, log))
    recording = open_recording(source, given=given(folder, log, find_offset=True))
    assert recording.attitudes is not None


def test_a_table_beside_stamped_pictures_is_no_paparazzi_flight(tmp_path: Path) -> None:
    folder = stamped(tmp_path / "imgs")
    log = log_of(folder / "imu.csv")
    recording = open_recording(folder, given=given(folder, log))
    assert recording.format == "pictures"
    assert all(header.up_cam is not None for header in recording.headers)


def test_accents_are_one_letter_or_two(tmp_path: Path) -> None:
    names = [f"Köln {index}.png" for index in range(3)]
    pictures(tmp_path / "set" / "images", [unicodedata.normalize("NFD", name) for name in names])
    rows = [f"{name},{index / 10},0.01,0.02" for index, name in enumerate(names)]
    (tmp_path / "set" / "frames.csv").write_text("\n".join(["image,time_s,roll_rad,pitch_rad", *rows]))
    recording = open_recording(tmp_path / "set")
    assert recording.read(1).image.shape == (24, 32, 3)


def test_a_slow_log_says_that_it_is_slow(tmp_path: Path) -> None:
    folder = stamped(tmp_path / "imgs")
    rows = [f"{1714570000 + index / 4:.2f},0.0,{index % 3}.5" for index in range(-1, 15)]
    log = tmp_path / "log.csv"
    log.write_text("\n".join(["time,roll_deg,pitch_deg", *rows]) + "\n")
    notes = open_recording(folder, given=given(folder, log)).notes
    assert any(isinstance(note, Doubt) and "every 0.25 s" in note for note in notes)


@pytest.mark.parametrize(("order", "told"), [("in order", False), ("ran over", True), ("shuffled", False)])
def test_a_clock_that_falls_back_is_told(tmp_path: Path, order: str, told: bool) -> None:
    times_s = 4294.0 + TIMES
    if order == "ran over":
        times_s = times_s % (2**32 * 1e-6)
    if order == "shuffled":
        times_s = np.random.default_rng(0).permutation(times_s)
    notes = angles_deg(table(tmp_path / "l.csv", "time_s,roll_deg,pitch_deg", times_s, ROLL_DEG, PITCH_DEG))[
        2
    ]
    assert any("falls back by 4294" in note for note in notes) == told
    assert any(isinstance(note, Doubt) for note in notes) == told


@pytest.mark.parametrize(("name", "way_out"), [("log.csv.gz", "unpack"), ("flight.tlog", "ATTITUDE")])
def test_files_that_are_no_text_get_a_way_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, way_out: str
) -> None:
    folder = stamped(tmp_path / "imgs")
    (tmp_path / name).write_bytes(gzip.compress(b"time,roll_deg,pitch_deg\n" * 50) + b"\0\0\1")
    camera = str(tmp_path / "camera.yaml")
    words = ["check-data", str(folder), "--camera", camera, "--attitude", str(tmp_path / name)]
    assert main(words) == 2
    assert way_out in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "told"), [("log.csv", "--attitude log.csv"), ("flight.bag.gz", "unpack"), ("set.zip", "unpack")]
)
def test_a_log_or_a_packed_file_given_as_a_recording(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, told: str
) -> None:
    (tmp_path / name).write_bytes(b"time,roll_deg,pitch_deg\n1,2,3\n")
    assert main(["check-data", str(tmp_path / name)]) == 2
    assert told in capsys.readouterr().err


def test_dates_that_are_not_read_get_a_way_out(tmp_path: Path) -> None:
    rows = [f"05/01/2024 12:30:{second:02d},1.5,2.5" for second in range(20)]
    path = tmp_path / "l.csv"
    path.write_text("\n".join(["time,roll_deg,pitch_deg", *rows]))
    with pytest.raises(InputError, match="2024-05-01 12:30:00") as refused:
        angles_deg(path)
    assert "row 1" in str(refused.value)
    rows = [f"2024-05-01 12:30:{second:02d} UTC,1.5,2.5" for second in range(20)]
    path.write_text("\n".join(["time,roll_deg,pitch_deg", *rows]))
    assert np.allclose(angles_deg(path)[0], 1.5)
