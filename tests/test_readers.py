"""Readers: tiny sets with attitudes known by hand, and the real sets."""

import math
import subprocess
import sys
from pathlib import Path

import make_sets
import numpy as np
import pytest

from horizon_dl.data.image_folder import FrameFiles
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.readers.kitti_times import parse_time
from horizon_dl.readers.registry import FORMATS, open_recording

LEVEL = [0.0, -1.0, 0.0]
MOUNT = (0.0, 0.0, 0.0)


def test_images_csv(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path / "myset")
    make_sets.save_image(folder / "labels" / "b.png", grey=True)
    make_sets.save_image(folder / "depth" / "b.png", grey=True)
    recording = open_recording(folder)
    assert (recording.name, recording.format, recording.length) == ("myset", "images_csv", 2)
    first, second = recording.headers
    assert (first.name, first.time_s, first.height_m) == ("images/a.png", 0.0, 1.5)
    np.testing.assert_allclose(first.up_cam, [-math.sin(0.1), -math.cos(0.1), 0.0], atol=1e-12)
    np.testing.assert_allclose(second.up_cam, [0.0, -math.cos(0.2), math.sin(0.2)], atol=1e-12)
    assert (first.labelled, second.labelled) == (False, True)
    files = FrameFiles(folder / "images/b.png", folder / "labels" / "b.png", folder / "depth" / "b.png")
    assert recording.load.files[1] == files
    assert recording.read(0).image.shape == (24, 32, 3)


def test_images_csv_sorts_by_time_and_needs_no_yaw_or_height(tmp_path: Path) -> None:
    rows = ["b.png,2.0,0.0,0.0", "a.png,1.0,0.0,0.0", "c.png,2.0,0.0,0.0"]
    folder = make_sets.images_csv(tmp_path, rows, "image,time_s,roll_rad,pitch_rad")
    recording = open_recording(folder)
    assert [entry.name for entry in recording.headers] == ["a.png", "b.png", "c.png"]
    assert all(entry.height_m is None for entry in recording.headers)


@pytest.mark.parametrize("cell", ["", "nan", "NaN", "inf"])
def test_images_csv_row_without_attitude_has_none(tmp_path: Path, cell: str) -> None:
    rows = ["a.png,0.0,0.0,0.0,0.0,", f"b.png,0.1,{cell},0.0,0.0,", "c.png,0.2,0.0,0.0,,"]
    entries = open_recording(make_sets.images_csv(tmp_path, rows)).headers
    assert [entry.up_cam is None for entry in entries] == [False, True, False]


def test_images_csv_applies_the_mount(tmp_path: Path) -> None:
    camera = make_sets.CAMERA_YAML.replace("[0.0, 0.0, 0.0]", "[0.0, -30.0, 0.0]")
    up = open_recording(make_sets.images_csv(tmp_path, ["a.png,0,0,0,0,1"], camera=camera)).headers[0].up_cam
    np.testing.assert_allclose(up, [0.0, -math.cos(math.pi / 6), -0.5], atol=1e-12)


@pytest.mark.parametrize("below", ["", "2011_09_26", "2011_09_26/2011_09_26_drive_0001_sync"])
def test_kitti_from_every_level(tmp_path: Path, below: str) -> None:
    recording = open_recording(make_sets.kitti(tmp_path) / below)
    assert (recording.name, recording.format) == ("2011_09_26_drive_0001_sync", "kitti")
    assert [entry.time_s for entry in recording.headers] == pytest.approx([0.0, 0.1], abs=1e-6)
    assert recording.headers[0].name.endswith("image_02/data/0000000000.png")
    np.testing.assert_allclose(recording.headers[0].up_cam, LEVEL, atol=1e-12)
    assert recording.headers[0].height_m == 1.65
    assert recording.camera.fx == 30.0


def test_ranges_come_with_their_unit(tmp_path: Path) -> None:
    kitti, tum = (
        open_recording(make_sets.kitti(tmp_path / "k")),
        open_recording(make_sets.tum(tmp_path / "t")),
    )
    images_csv = open_recording(make_sets.images_csv(tmp_path / "i"))
    units = [(one.load.range_unit.metres, one.load.range_unit.along) for one in (kitti, tum, images_csv)]
    assert units == [(1 / 256, "ray"), (1 / 5000, "axis"), (0.001, "axis")]


def test_kitti_floor_stays_under_the_car_however_it_tilts(tmp_path: Path) -> None:
    recording = open_recording(make_sets.kitti(tmp_path, "49 8 110 0.1 -0.2 0.7"))
    np.testing.assert_allclose(recording.headers[0].floor_up_cam, LEVEL, atol=1e-12)
    assert np.abs(recording.headers[0].up_cam - LEVEL).max() > 0.1
    np.testing.assert_array_equal(recording.read(0).floor_up_cam, recording.headers[0].floor_up_cam)


def test_kitti_angles_against_forward_left_up(tmp_path: Path) -> None:
    # Roll > 0: left side up, as for FRD. Pitch > 0: front DOWN, against FRD.
    rolled = open_recording(make_sets.kitti(tmp_path / "a", "49 8 110 0.1 0 0.7")).headers[0].up_cam
    np.testing.assert_allclose(rolled, [-math.sin(0.1), -math.cos(0.1), 0.0], atol=1e-12)
    pitched = open_recording(make_sets.kitti(tmp_path / "b", "49 8 110 0 0.1 -2.0")).headers[0].up_cam
    np.testing.assert_allclose(pitched, [0.0, -math.cos(0.1), -math.sin(0.1)], atol=1e-12)


def test_kitti_frame_without_oxts_has_no_attitude(tmp_path: Path) -> None:
    folder = make_sets.kitti(tmp_path)
    next(folder.rglob("oxts/data/0000000001.txt")).unlink()
    assert [entry.up_cam is None for entry in open_recording(folder).headers] == [False, True]


def test_kitti_time_has_nanoseconds() -> None:
    seconds = parse_time(Path("t"), "1970-01-01 00:01:00.123456789")
    assert seconds == pytest.approx(60.123456789, abs=1e-9)


@pytest.mark.parametrize("below", ["", "flight"])
def test_paparazzi_interpolates_at_the_images_time(tmp_path: Path, below: str) -> None:
    make_sets.paparazzi(tmp_path, start_s=9.9955)
    make_sets.save_image(tmp_path / "labels" / "10050000.png", grey=True)
    recording = open_recording(tmp_path / below)
    assert (recording.name, recording.format, recording.length) == ("flight", "paparazzi", 4)
    for entry in recording.headers:
        pitch = entry.time_s - 9.9955
        np.testing.assert_allclose(entry.up_cam, [0, -math.cos(pitch), math.sin(pitch)], atol=1e-6)
        assert entry.height_m == pytest.approx(1.0)
    assert [header.labelled for header in recording.headers] == [False, True, False, False]
    assert recording.headers[1].name == "flight/10050000.jpg"


def test_paparazzi_leaves_out_frames_on_the_ground(tmp_path: Path) -> None:
    make_sets.paparazzi(tmp_path)
    log = tmp_path / "flight.csv"
    lines = log.read_text().splitlines()
    lines[1:8] = [line.replace(",5000", ",0") for line in lines[1:8]]
    log.write_text("\n".join(lines))
    recording = open_recording(tmp_path)
    assert recording.length == 2
    assert recording.notes == ("2 of 4 images left out: on the ground",)


def test_tum(tmp_path: Path) -> None:
    recording = open_recording(make_sets.tum(tmp_path))
    assert recording.format == "tum"
    assert (recording.camera.fx, recording.camera.cy) == (535.4, 247.6)
    np.testing.assert_allclose(recording.headers[0].up_cam, LEVEL, atol=1e-6)
    assert recording.headers[0].height_m == pytest.approx(1.2)


@pytest.mark.parametrize("truth", [False, True])
@pytest.mark.parametrize("below", ["", "mav0"])
def test_euroc(tmp_path: Path, truth: bool, below: str) -> None:
    recording = open_recording(make_sets.euroc(tmp_path, truth) / below)
    assert (recording.format, recording.length) == ("euroc", 3)
    for entry in recording.headers:
        np.testing.assert_allclose(entry.up_cam, LEVEL, atol=1e-6)
    assert bool(recording.notes) is not truth
    assert recording.read(0).image.shape == (24, 32, 3)


def test_format_can_be_named(tmp_path: Path) -> None:
    make_sets.images_csv(tmp_path)
    make_sets.tum(tmp_path)
    assert open_recording(tmp_path).format == "images_csv"
    (tmp_path / "camera.yaml").unlink()
    assert open_recording(tmp_path, "tum").format == "tum"
    assert {"images_csv", "kitti", "paparazzi", "tum", "euroc", "film", "pictures"} <= set(FORMATS)


def test_opening_a_set_imports_nothing_heavy() -> None:
    code = (
        "import sys, horizon_dl.readers.registry, horizon_dl.data.images, horizon_dl.geometry.camera\n"
        "print([m for m in ('torch', 'kornia', 'scipy', 'skimage', 'sklearn') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


REAL = {  # folder: format, frames, without attitude, truths, ranges, height range, row range of the horizon
    "arena": ("paparazzi", 373, 0, 7, 0, (0.3, 2.0), (60, 180)),
    "corridor": ("images_csv", 220, 0, 220, 220, (1.0, 1.6), (100, 240)),
    "hallway": ("images_csv", 91, 0, 9, 0, (0.3, 2.5), (150, 340)),
    "kitti": ("kitti", 60, 0, 60, 60, (1.65, 1.65), (150, 200)),
    "tum_sample": ("tum", 17, 1, 0, 4, (0.9, 1.3), (80, 130)),
    "euroc_sample": ("euroc", 16, 0, 0, 0, None, (60, 110)),
}


@pytest.mark.real_data
@pytest.mark.parametrize("name", list(REAL))
def test_real_set(data_dir: Path, name: str) -> None:
    format_, frames, blind, truths, ranges, heights, rows = REAL[name]
    recording = open_recording(data_dir / name)
    entries = recording.headers
    ups = [entry.up_cam for entry in entries if entry.up_cam is not None]
    assert (recording.format, len(entries), len(entries) - len(ups)) == (format_, frames, blind)
    assert sum(entry.labelled for entry in entries) == truths
    assert sum(files.ranges is not None for files in recording.load.files) == ranges
    assert [e.time_s for e in entries] == sorted(e.time_s for e in entries)
    np.testing.assert_allclose(np.linalg.norm(ups, axis=-1), 1.0, atol=1e-9)
    if heights is not None:
        known = [e.height_m for e in entries if e.height_m is not None]
        assert heights[0] <= min(known) <= max(known) <= heights[1]
    # Row of the horizon below the principal point, of the camera without its lens.
    camera = recording.camera
    middle = np.median([camera.cy - camera.fy * up[2] / up[1] for up in ups])
    assert rows[0] < middle < rows[1]


@pytest.mark.real_data
@pytest.mark.parametrize("name", list(REAL))
def test_real_frame_is_read(data_dir: Path, name: str) -> None:
    recording = open_recording(data_dir / name)
    index = next((i for i, entry in enumerate(recording.headers) if entry.labelled), 1)
    frame = recording.read(index)
    assert frame.image.shape == (recording.camera.height, recording.camera.width, 3)
    if recording.headers[index].labelled:
        assert frame.truth is not None
        assert frame.truth.shape == frame.image.shape[:2]


def test_readers_agree_on_one_attitude(tmp_path: Path) -> None:
    # The same attitude, roll 0.1 and nose 0.05 up, told in two conventions.
    own = open_recording(make_sets.images_csv(tmp_path / "a", ["a.png,0,0.1,0.05,1.0,1"])).headers[0].up_cam
    oxts = open_recording(make_sets.kitti(tmp_path / "b", "49 8 110 0.1 -0.05 -1.0")).headers[0].up_cam
    np.testing.assert_allclose(own, oxts, atol=1e-12)
    np.testing.assert_allclose(own, up_in_camera(quaternion_from_rpy(0.1, 0.05, 1.0), MOUNT), atol=1e-12)
