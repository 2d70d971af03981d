"""Every broken set gives one clear line that names the file, the problem and a hint."""

import contextlib
import random
from collections.abc import Callable
from pathlib import Path

import make_sets
import pytest

from horizon_dl.errors import InputError
from horizon_dl.readers.registry import FORMATS, open_recording

FOLDERS = ("images_csv", "kitti", "paparazzi", "tum", "euroc")


def message(folder: Path, format_: str | None = None) -> str:
    with pytest.raises(InputError) as caught:
        open_recording(folder, format_)
    text = str(caught.value)
    assert "\n" not in text
    assert "; " in text
    return text


def test_folder_that_is_no_set(tmp_path: Path) -> None:
    text = message(tmp_path)
    assert "is empty" in text
    assert all(name in text for name in FORMATS)
    (tmp_path / "notes.txt").write_text("hello")
    assert "is not a recording of a known format" in message(tmp_path)
    assert "does not exist" in message(tmp_path / "none")
    assert "is not a recording of a known format" in message(tmp_path / "notes.txt")
    assert "choose one of images_csv" in message(tmp_path, "rosbag")


@pytest.mark.parametrize("name", FOLDERS)
def test_named_format_that_is_not_there(tmp_path: Path, name: str) -> None:
    assert str(tmp_path) in message(tmp_path, name)


@pytest.mark.parametrize("column", ["image", "time_s", "roll_rad", "pitch_rad"])
def test_missing_column(tmp_path: Path, column: str) -> None:
    header = "image,time_s,roll_rad,pitch_rad,yaw_rad,height_m".replace(column, "other")
    text = message(make_sets.images_csv(tmp_path, header=header))
    assert "frames.csv" in text
    assert f"has no column '{column}'" in text


def test_attitude_that_is_nan_everywhere(tmp_path: Path) -> None:
    text = message(make_sets.images_csv(tmp_path, ["a.png,0,nan,0,0,1", "b.png,1,,0,0,1"]))
    assert "no frame has an attitude" in text


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("a.png,soon,0,0,0,1", "row 1, column 'time_s' holds 'soon'"),
        ("a.png,0,level,0,0,1", "row 1, column 'roll_rad' holds 'level'"),
        ("a.png,,0,0,0,1", "row 1 has no image or no time"),
        (",0,0,0,0,1", "row 1 has no image or no time"),
        ("a.png", "row 1 has no image or no time"),
    ],
)
def test_wrong_cells(tmp_path: Path, row: str, words: str) -> None:
    assert words in message(make_sets.images_csv(tmp_path, [row]))


def test_header_only_and_missing_images(tmp_path: Path) -> None:
    assert "has no rows" in message(make_sets.images_csv(tmp_path / "a", []))
    folder = make_sets.images_csv(tmp_path / "b")
    for image in (folder / "images").iterdir():
        image.unlink()
    assert "none of the 2 images is there" in message(folder)


def test_camera_file_missing_or_lacking_a_field(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path)
    (folder / "camera.yaml").write_text(make_sets.CAMERA_YAML.replace("fx: 30.0\n", ""))
    assert "has no field 'fx'" in message(folder)
    (folder / "camera.yaml").unlink()
    assert "camera.yaml: is missing" in message(folder)


def test_binary_where_text_is_expected(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path)
    (folder / "frames.csv").write_bytes(b"\xff\xfe\x00\x80\x81")
    assert "cannot be read as text" in message(folder)


def test_several_kitti_drives(tmp_path: Path) -> None:
    make_sets.kitti(tmp_path)
    make_sets.kitti(tmp_path, drive="2011_09_26_drive_0002_sync")
    text = message(tmp_path)
    assert "holds 2 drives" in text
    assert "2011_09_26_drive_0001_sync, 2011_09_26/2011_09_26_drive_0002_sync" in text


@pytest.mark.parametrize("name", ["calib_cam_to_cam.txt", "calib_imu_to_velo.txt", "calib_velo_to_cam.txt"])
def test_kitti_calibration(tmp_path: Path, name: str) -> None:
    path = make_sets.kitti(tmp_path) / "2011_09_26" / name
    path.write_text("calib_time: 09-Jan-2012 13:57:47\nR: 1 2 3\nP_rect_02: a b c\n")
    assert name in message(tmp_path)
    path.unlink()
    assert f"{name}: is missing" in message(tmp_path)


@pytest.mark.parametrize("content", ["", "49 8 110", "49 8 110 nan nan nan", "a b c d e f"])
def test_kitti_without_any_attitude(tmp_path: Path, content: str) -> None:
    for path in make_sets.kitti(tmp_path).rglob("oxts/data/*.txt"):
        path.write_text(content)
    assert "no frame has an attitude" in message(tmp_path)


TIMES_APART: list[Callable[[Path], Path]] = [
    lambda folder: make_sets.paparazzi(folder, start_s=500.0),
    lambda folder: make_sets.tum(folder, start_s=5000.0),
    lambda folder: make_sets.euroc(folder, imu_start_ns=900_000_000_000),
]


@pytest.mark.parametrize("make", TIMES_APART, ids=["paparazzi", "tum", "euroc"])
def test_times_that_never_meet(tmp_path: Path, make: Callable[[Path], Path]) -> None:
    assert "they never meet" in message(make(tmp_path))


def test_paparazzi_column_camera_ground_and_two_flights(tmp_path: Path) -> None:
    bad = make_sets.paparazzi(tmp_path / "a", header="time,pos_z,att_phi,pitch,att_psi,cmd_thrust")
    assert "has no column 'att_theta'" in message(bad)
    (make_sets.paparazzi(tmp_path / "b") / "camera.yaml").unlink()
    assert "camera.yaml: is missing" in message(tmp_path / "b")
    assert "on the ground" in message(make_sets.paparazzi(tmp_path / "c", height_m=0.0))
    two = make_sets.paparazzi(tmp_path / "d")
    make_sets.save_image(two / "other" / "12.jpg")
    (two / "other.csv").write_text((two / "flight.csv").read_text())
    assert "holds 2 flights: flight, other" in message(two)


def test_tum_camera_and_files(tmp_path: Path) -> None:
    assert "add a camera.yaml" in message(make_sets.tum(tmp_path / "a", comment="# color images"))
    folder = make_sets.tum(tmp_path / "b")
    (folder / "rgb.txt").write_text("# freiburg3\nsoon rgb/a.png\n")
    assert "lines are 'time filename'" in message(folder)
    (folder / "groundtruth.txt").unlink()
    assert "groundtruth.txt: is missing" in message(folder)


def test_euroc_files(tmp_path: Path) -> None:
    folder = make_sets.euroc(tmp_path)
    sensor = folder / "mav0" / "cam0" / "sensor.yaml"
    text = sensor.read_text()
    sensor.write_text(text.replace("intrinsics", "intrinsic"))
    assert "has no field 'intrinsics'" in message(folder)
    sensor.write_text(text)
    imu = folder / "mav0" / "imu0" / "data.csv"
    lines = imu.read_text().splitlines()
    imu.write_text("\n".join([*lines[:5], "12,a", *lines[5:]]))
    assert "line 6 has no 7 numbers" in message(folder)
    imu.unlink()
    assert "neither state_groundtruth_estimate0, mocap0 nor imu0" in message(folder)


def test_log_that_is_cut_off_in_its_last_line_is_read(tmp_path: Path) -> None:
    folder = make_sets.euroc(tmp_path)
    imu = folder / "mav0" / "imu0" / "data.csv"
    imu.write_text(imu.read_text()[:-9])
    assert len(open_recording(folder).headers) == 3


def test_euroc_samples_that_are_zero_give_no_attitude(tmp_path: Path) -> None:
    folder = make_sets.euroc(tmp_path / "imu")
    imu = folder / "mav0" / "imu0" / "data.csv"
    imu.write_text(imu.read_text().replace("9.81", "0"))
    assert "no frame has an attitude" in message(folder)
    folder = make_sets.euroc(tmp_path / "truth", truth=True)
    truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    lines = [",".join([*line.split(",")[:4], "0,0,0,0"]) for line in truth.read_text().splitlines()]
    truth.write_text("\n".join(lines))
    assert "holds no usable samples" in message(folder)


MAKERS: list[Callable[[Path], Path]] = [
    make_sets.images_csv,
    make_sets.kitti,
    make_sets.paparazzi,
    make_sets.tum,
    make_sets.euroc,
    lambda folder: make_sets.euroc(folder, truth=True),
]
SUFFIXES = {".csv", ".txt", ".yaml"}


@pytest.mark.parametrize("make", MAKERS, ids=[*FOLDERS, "euroc_truth"])
def test_damaged_text_never_gives_another_error(tmp_path: Path, make: Callable[[Path], Path]) -> None:
    folder = make(tmp_path)
    rng = random.Random(0)
    for path in sorted(p for p in folder.rglob("*") if p.suffix in SUFFIXES):
        whole = path.read_bytes()
        for _ in range(25):
            damaged = bytearray(whole)
            at = rng.randrange(len(damaged))
            kind = rng.randrange(3)
            if kind == 0:  # a piece is lost
                del damaged[at : at + rng.randrange(1, 40)]
            elif kind == 1:  # cut off
                del damaged[at:]
            else:  # bytes overwritten
                damaged[at : at + 3] = bytes(rng.choice(b"0-9,.:x\n \xff[]{}e#nan") for _ in range(3))
            path.write_bytes(bytes(damaged))
            with contextlib.suppress(InputError):
                assert open_recording(folder).headers
        path.write_bytes(whole)
    assert open_recording(folder).headers
