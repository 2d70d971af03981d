"""Recordings with their attitude in or beside them: GoPro, phones, DJI's photos, pictures with a log."""

import os
import re
from dataclasses import replace
from pathlib import Path

import make_films
import make_sets
import numpy as np
import pytest
from fuzz import sets

from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy, rotation_from_quaternion
from horizon_dl.inspection.timing_and_attitude import camera_angles_deg, known_ups
from horizon_dl.readers.mars import exposure_starts
from horizon_dl.sources.open_source import open_source

LOGS, DATA = Path(os.environ.get("HORIZON_DL_LOGS", "none")), Path(os.environ.get("HORIZON_DL_DATA", "none"))
needs_logs = pytest.mark.skipif(not LOGS.is_dir(), reason="needs HORIZON_DL_LOGS")


def opened(path: Path, given: Given = NOTHING_GIVEN) -> Recording:
    recording = open_source(path, None, given)
    assert isinstance(recording, Recording)
    return recording


@needs_logs
def test_a_gopros_film_knows_its_attitude() -> None:
    path = LOGS / "gopro_max" / "max-heromode.mp4"
    with pytest.raises(InputError, match="its camera is not"):
        opened(path)
    recording = opened(path, Given(DATA / "gopro_max_path" / "camera.yaml"))
    assert (recording.format, recording.length) == ("gopro", 315)
    assert len(known_ups(recording.headers)) == 315


@needs_logs
def test_a_phones_film_is_upright() -> None:
    recording = opened(LOGS / "phone_mars")
    assert (recording.format, recording.length) == ("mars", 25)
    assert recording.calibrated.fx == pytest.approx(980.48, abs=0.01)
    roll, pitch = camera_angles_deg(known_ups(recording.headers))
    assert np.median(roll) == pytest.approx(-1.1, abs=0.3)
    assert np.median(pitch) == pytest.approx(-9.4, abs=0.3)


@needs_logs
def test_a_djis_photo_is_its_gimbals() -> None:
    recording = opened(LOGS / "dji_xmp")
    assert recording.format == "dji_photos"
    # Pitch -89.90: up points backwards, to the upper edge of the picture by a tenth of a degree.
    assert recording.headers[0].up_cam == pytest.approx([0, -np.sin(np.deg2rad(0.1)), -1], abs=1e-5)


@pytest.mark.parametrize("name", ["GimbalRollDegree", "GimbalPitchDegree", "CalibratedFocalLength"])
@pytest.mark.parametrize("value", ["1e999", "nan", "-inf", "", "x", "1e300"])
def test_numbers_in_a_photo_that_cannot_be(tmp_path: Path, name: str, value: str) -> None:
    folder = sets.dji_photos(tmp_path / "set")
    for path in folder.iterdir():
        content = path.read_bytes()
        path.write_bytes(re.sub(rf'{name}="[^"]*"'.encode(), f'{name}="{value}"'.encode(), content))
    if name == "CalibratedFocalLength" and value in ("1e999", "nan", "-inf", "1e300"):
        with pytest.raises(InputError, match="tells no focal length"):
            opened(folder)
        return
    if name != "CalibratedFocalLength":
        with pytest.raises(InputError):
            opened(folder)
        return
    recording = opened(folder)
    assert np.isfinite(recording.camera.fx)
    ups = [header.up_cam for header in recording.headers if header.up_cam is not None]
    assert all(np.linalg.norm(up) == pytest.approx(1) for up in ups)


def test_past_the_nadir_roll_180_is_the_same_attitude_in_other_words() -> None:
    def rotation(*degrees: float) -> np.ndarray:
        return rotation_from_quaternion(quaternion_from_rpy(*np.deg2rad(degrees)))

    assert rotation(180, -85, 225) == pytest.approx(rotation(0, -95, 45))


def test_stamps_and_frames_are_paired_by_their_pauses() -> None:
    starts = exposure_starts(np.array([0.0, 0.1, 0.3]), np.array([7.0, 7.05, 7.15, 7.36]))
    assert starts == pytest.approx([7.05, 7.15, 7.36])


@pytest.mark.parametrize("name", ["{:.6f}.png", "frame_{:.3f}.png"])
def test_pictures_are_paired_with_a_log_by_the_times_in_their_names(tmp_path: Path, name: str) -> None:
    for index in range(5):
        make_sets.save_image(tmp_path / "set" / name.format(100.0 + index / 10))
    (tmp_path / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    rows = "\n".join(f"{99 + n / 50:.2f},0.0,{n / 1000},0.0" for n in range(100))
    (tmp_path / "log.csv").write_text(f"time_s,roll_rad,pitch_rad,yaw_rad\n{rows}\n")
    recording = opened(tmp_path / "set", Given(tmp_path / "camera.yaml", str(tmp_path / "log.csv")))
    _, pitch = camera_angles_deg(known_ups(recording.headers))
    assert np.deg2rad(pitch) == pytest.approx([0.05 + 0.005 * index for index in range(5)], abs=1e-6)


def test_pictures_that_only_count_are_not_guessed_at(tmp_path: Path) -> None:
    for index in range(5):
        make_sets.save_image(tmp_path / "set" / f"{index:06d}.png")
    (tmp_path / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    rows = "\n".join(f"{n / 50:.2f},0.0,0.0,0.0" for n in range(100))
    (tmp_path / "log.csv").write_text(f"time_s,roll_rad,pitch_rad,yaw_rad\n{rows}\n")
    with pytest.raises(InputError, match="tell no times"):
        opened(tmp_path / "set", Given(tmp_path / "camera.yaml", str(tmp_path / "log.csv")))


@pytest.fixture
def counted(tmp_path: Path) -> Given:
    """Five pictures that only count, of 100 s and every tenth of a second, and a log that pitches up."""
    for index in range(5):
        make_sets.save_image(tmp_path / "set" / "left" / f"{index:06d}.png")
    (tmp_path / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    rows = "\n".join(f"{99 + n / 50:.2f},0.0,{n / 1000},0.0" for n in range(100))
    (tmp_path / "log.csv").write_text(f"time_s,roll_rad,pitch_rad,yaw_rad\n{rows}\n")
    return Given(tmp_path / "camera.yaml", str(tmp_path / "log.csv"))


def pitches_rad(recording: Recording) -> np.ndarray:
    return np.deg2rad(camera_angles_deg(known_ups(recording.headers))[1])


RIGHT = pytest.approx([0.05 + 0.005 * index for index in range(5)], abs=1e-6)
TIMES = {
    "seconds": [f"{100 + k / 10:.3f}" for k in range(5)],
    "with a header": ["timestamp", *(f"{100 + k / 10:.3f}" for k in range(5))],
    "exponents": [f"{100 + k / 10:.6e}" for k in range(5)],
    "with an exposure": [f"{k} {100 + k / 10:.3f} {10.5 + k}" for k in range(5)],
    "seconds and nanoseconds": ["sec,nsec", *(f"{100},{k * 10**8}" for k in range(5))],
    "named second": ["timestamp,frame_id", *(f"{100 + k / 10:.3f},{1000 + 40 * k}" for k in range(5))],
    "numbered": [f"{k} {100 + k / 10:.3f}" for k in range(5)],
    "nanoseconds": ["# cam0", *(f"{(1000 + k) * 100_000_000}" for k in range(5))],
    "milliseconds": [f"{100_000 + 100 * k}" for k in range(5)],
    "of day": [f"00:01:40.{k}" for k in range(5)],
    "dates": [f"1970-01-01 00:01:40.{k}00000000" for k in range(5)],
}


@pytest.mark.parametrize("lines", [[f"{100 + k}.0" for k in range(5)], ["time_s", *"01234"]])
def test_a_picture_a_second_is_no_count(tmp_path: Path, counted: Given, lines: list[str]) -> None:
    (tmp_path / "set" / "timestamps.txt").write_text("\n".join(lines))
    start_s = float(lines[-5])
    recording = opened(tmp_path / "set" / "left", replace(counted, time_offset_s=start_s - 100.0))
    assert [header.time_s for header in recording.headers] == [start_s + k for k in range(5)]


@pytest.mark.parametrize("name", ["timestamps.txt", "left/times.txt", "left_timestamps.csv"])
@pytest.mark.parametrize("kind", TIMES)
def test_a_list_of_times_beside_the_pictures(tmp_path: Path, counted: Given, kind: str, name: str) -> None:
    (tmp_path / "set" / name).write_text("\n".join(TIMES[kind]) + "\n")
    assert pitches_rad(opened(tmp_path / "set" / "left", counted)) == RIGHT


@pytest.mark.parametrize(
    "lines",
    [
        TIMES["seconds"][:4],
        TIMES["seconds"][::-1],
        ["1", "one", "2", "3", "4"],
        [],
        ["0", "1", "2", "3", "4"],
        [f"{100_000 + 5 * k}" for k in range(5)],  # 200 a second, or one in 5 seconds
        [f"{100 + k} {300 + k}" for k in range(5)],
        ["name", *"abcde"],
        ["1,010", "2,025", "3,041", "4,055", "5,070"],
    ],
)
def test_a_list_that_does_not_fit_is_named(tmp_path: Path, counted: Given, lines: list[str]) -> None:
    (tmp_path / "set" / "timestamps.txt").write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=r"timestamps\.txt"):
        opened(tmp_path / "set" / "left", counted)


LISTS = {
    "table": ["time_s,file", *(f"{100 + k / 10:.1f},{k:06d}.png" for k in range(5))],
    "folders": [
        "# id timestamp image_name",
        *(f"{k} {100 + k / 10:.1f} left/{k:06d}.png" for k in range(5)),
    ],
    "nanoseconds": ["#timestamp [ns],filename", *(f"{(1000 + k) * 10**8},{k:06d}.png" for k in range(5))],
}


@pytest.mark.parametrize("kind", LISTS)
def test_a_table_of_pictures_and_times(tmp_path: Path, counted: Given, kind: str) -> None:
    (tmp_path / "set" / "left_images.txt").write_text("\n".join(LISTS[kind]))
    assert pitches_rad(opened(tmp_path / "set" / "left", counted)) == RIGHT
    if kind == "folders":
        assert pitches_rad(opened(tmp_path / "set" / "left_images.txt", counted)) == RIGHT


def test_each_camera_has_its_own_list(
    tmp_path: Path, counted: Given, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "\n".join(LISTS["folders"])
    for index in range(5):
        make_sets.save_image(tmp_path / "set" / "right" / f"{index:06d}.png")
    (tmp_path / "set" / "right_images.txt").write_text(text.replace("left", "right"))
    with pytest.raises(InputError, match="tell no times"):  # the list of the other camera
        opened(tmp_path / "set" / "left", counted)
    (tmp_path / "set" / "left_images.txt").write_text(text)
    for path in (tmp_path / "set" / "left", tmp_path / "set" / "right"):
        recording = opened(path, counted)
        assert pitches_rad(recording) == RIGHT
        assert (recording.name, recording.headers[0].name) == (path.name, "000000.png")
    monkeypatch.chdir(tmp_path / "set" / "left")
    assert pitches_rad(opened(Path(), counted)) == RIGHT
    recording = opened(tmp_path / "set" / "right_images.txt", counted)
    assert recording.headers[0].name == "right/000000.png"
    with pytest.raises(InputError, match=r"has no attitude.*give --attitude LOG"):
        opened(tmp_path / "set" / "right_images.txt", Given(camera=counted.camera))


def test_of_two_lists_of_the_same_pictures_one_is_chosen(tmp_path: Path, counted: Given) -> None:
    for name in ("a.txt", "b.txt"):
        (tmp_path / "set" / name).write_text("\n".join(LISTS["folders"]))
    with pytest.raises(InputError, match=r"a\.txt, b\.txt; give one of them as DATA"):
        opened(tmp_path / "set" / "left", counted)
    for name in ("times.txt", "timestamps.txt"):
        (tmp_path / "set" / name).write_text("\n".join(TIMES["seconds"]))
    for name in ("a.txt", "b.txt"):
        (tmp_path / "set" / name).unlink()
    with pytest.raises(InputError, match=r"times\.txt, timestamps\.txt; leave one"):
        opened(tmp_path / "set" / "left", counted)


def test_another_sensors_times_are_not_the_cameras(tmp_path: Path, counted: Given) -> None:
    (tmp_path / "set" / "imu_timestamps.txt").write_text("\n".join(f"{k / 50}" for k in range(60)))
    (tmp_path / "set" / "right_timestamps.txt").write_text("\n".join(TIMES["seconds"]))
    with pytest.raises(InputError, match="tell no times"):
        opened(tmp_path / "set" / "left", counted)
    (tmp_path / "set" / "timestamps.txt").write_text("\n".join(TIMES["seconds"]))
    assert pitches_rad(opened(tmp_path / "set" / "left", counted)) == RIGHT


def test_a_log_beside_a_film_that_needs_none_does_not_stop_it(tmp_path: Path) -> None:
    make_films.film(tmp_path / "a.mp4", range(0, 1000, 40), size=(32, 24))
    (tmp_path / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    samples = "".join(f"{k},{k % 3},0,0,0,0,1\n" for k in range(1000))
    settings = "tscale,0.001\ngscale,0.1\nascale,1\nt,gx,gy,gz,ax,ay,az\n"
    (tmp_path / "a.gcsv").write_text(f"GYROFLOW IMU LOG\n{settings}{samples}")
    with pytest.raises(InputError, match="--imu-axes"):
        opened(tmp_path / "a.mp4")
    assert opened(tmp_path / "a.mp4", Given(needs_attitude=False)).length == 25
    rows = "\n".join(f"{n / 50:.2f},0.0,0.1,0.0" for n in range(60))
    (tmp_path / "a.csv").write_text(f"time_s,roll_rad,pitch_rad,yaw_rad\n{rows}\n")
    assert len(known_ups(opened(tmp_path / "a.mp4").headers)) == 25  # the attitude, and not the samples


def test_a_phones_pictures_without_a_camera_can_be_looked_at(tmp_path: Path) -> None:
    for name in ("Gravity.csv", "Metadata.csv"):
        (tmp_path / name).write_text("time,seconds_elapsed,x,y,z\n1600000000000000000,0,0,9.8,0\n")
    make_sets.save_image(tmp_path / "Camera" / "1600000000000.png")
    assert opened(tmp_path, Given(needs_attitude=False)).length == 1


def test_an_attitude_without_a_camera_is_not_left_out_in_silence(counted: Given, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give --camera FILE"):
        opened(tmp_path / "set" / "left", Given(attitude=counted.attitude, needs_attitude=False))
    (tmp_path / "film").mkdir()
    make_films.film(tmp_path / "film" / "a.mp4", range(0, 1000, 40), size=(32, 24))
    with pytest.raises(InputError, match="give --camera FILE"):
        opened(tmp_path / "film" / "a.mp4", Given(attitude=counted.attitude, needs_attitude=False))


def test_a_log_beside_a_film_is_taken(tmp_path: Path) -> None:
    make_films.film(tmp_path / "a.mp4", range(0, 1000, 40), size=(32, 24))
    (tmp_path / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    rows = "\n".join(f"{n / 50:.2f},0.0,0.1,0.0" for n in range(60))
    (tmp_path / "a.csv").write_text(f"time_s,roll_rad,pitch_rad,yaw_rad\n{rows}\n")
    recording = opened(tmp_path)
    assert len(known_ups(recording.headers)) == recording.length == 25
    assert "the log from 0.000 to 1.180 s" in recording.notes[0]
