"""The data sets' layouts as people have them: other cameras, names, folders, and times that do not agree."""

import math
import shutil
from pathlib import Path

import make_sets
import numpy as np
import pytest

from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import rotation_from_rpy
from horizon_dl.readers.beside import files_beside
from horizon_dl.readers.registry import open_recording

LEVEL = [0.0, -1.0, 0.0]
DRIVE = "2011_09_26_drive_0001_sync"
START_S = 1000


def roll_of(recording: Recording) -> list[float]:
    """Roll (rad, right side down) of the cameras, which look level."""
    return [math.atan2(-h.up_cam[0], -h.up_cam[1]) for h in recording.headers if h.up_cam is not None]


def stamp(seconds: float) -> str:
    return f"2011-09-26 13:02:{seconds:012.9f}\n"


def kitti(
    folder: Path,
    *,
    oxts_hz: float = 10.0,
    oxts_start_s: float = 0.0,
    camera: str = "02",
    images: int = 5,
    size: tuple[int, int] = (32, 24),
) -> Path:
    """Images at 10 Hz from 1 s on; the roll is a tenth of the time in s; the oxts last 3 s."""
    make_sets.kitti(folder)
    date = folder / "2011_09_26"
    drive = date / DRIVE
    shutil.rmtree(drive)
    for index in range(images):
        make_sets.save_image(drive / f"image_{camera}" / "data" / f"{index:010d}.png", *size)
    (drive / f"image_{camera}" / "timestamps.txt").write_text(
        "".join(stamp(1 + 0.1 * index) for index in range(images))
    )
    (drive / "oxts" / "data").mkdir(parents=True)
    times = oxts_start_s + np.arange(int(3 * oxts_hz)) / oxts_hz
    for index, time_s in enumerate(times):
        (drive / "oxts" / "data" / f"{index:010d}.txt").write_text(f"49 8 110 {0.1 * time_s} 0 0" + " 0" * 24)
    (drive / "oxts" / "timestamps.txt").write_text("".join(stamp(time_s) for time_s in times))
    calib = (date / "calib_cam_to_cam.txt").read_text()
    for number in ("00", "01", "03"):
        calib += f"S_rect_{number}: 32 24\nP_rect_{number}: {30 + int(number)} 0 15.5 4 0 30 11.5 0 0 0 1 0\n"
    calib += "S_02: 40 30\nK_02: 35 0 19.5 0 35 14.5 0 0 1\nD_02: -0.2 0.1 0 0 0\n"
    tilt = " ".join(map(str, rotation_from_rpy(0.0, 0.0, 0.05).ravel()))
    (date / "calib_cam_to_cam.txt").write_text(f"{calib}R_02: {tilt}\n")
    return folder


@pytest.mark.parametrize("oxts_hz", [10.0, 50.0, 100.0])
@pytest.mark.parametrize("oxts_start_s", [0.0, 0.53, 0.98])
def test_kitti_is_paired_by_time(tmp_path: Path, oxts_hz: float, oxts_start_s: float) -> None:
    recording = open_recording(kitti(tmp_path, oxts_hz=oxts_hz, oxts_start_s=oxts_start_s))
    assert roll_of(recording) == pytest.approx([0.1 + 0.01 * index for index in range(5)], abs=1e-6)
    assert [h.time_s for h in recording.headers] == pytest.approx([0.1 * index for index in range(5)])


def test_kitti_outside_of_the_oxts_has_no_attitude(tmp_path: Path) -> None:
    recording = open_recording(kitti(tmp_path, oxts_start_s=1.26, oxts_hz=100.0))
    assert [h.up_cam is None for h in recording.headers] == [True, True, True, False, False]


@pytest.mark.parametrize("gone", ["image_02/timestamps.txt", "oxts/timestamps.txt"])
def test_kitti_never_pairs_100_hz_by_number(tmp_path: Path, gone: str) -> None:
    (kitti(tmp_path, oxts_hz=100.0) / "2011_09_26" / DRIVE / gone).unlink()
    with pytest.raises(InputError, match=r"300 oxts for 5 images, and no .* time stamps.*timestamps.txt"):
        open_recording(tmp_path)


def test_kitti_reduced_oxts_need_no_images_stamps(tmp_path: Path) -> None:
    folder = kitti(tmp_path)
    (folder / "2011_09_26" / DRIVE / "image_02" / "timestamps.txt").unlink()
    assert roll_of(open_recording(folder)) == pytest.approx([0.01 * index for index in range(5)], abs=1e-6)


@pytest.mark.parametrize("camera", ["00", "01", "03"])
@pytest.mark.parametrize("named", [False, True])
def test_kitti_other_cameras(tmp_path: Path, camera: str, named: bool) -> None:
    folder = kitti(tmp_path, camera=camera)
    drive = folder / "2011_09_26" / DRIVE
    if named:  # beside the one that is taken without a word
        shutil.copytree(drive / f"image_{camera}", drive / "image_02")
        assert f"image_{camera} can be given" in open_recording(folder).notes[0]
    recording = open_recording(drive / f"image_{camera}" if named else folder)
    assert recording.format == "kitti"
    assert recording.calibrated.fx == 30 + int(camera)
    assert roll_of(recording)[0] == pytest.approx(0.1)


def test_kitti_unsynced_images_are_distorted(tmp_path: Path) -> None:
    recording = open_recording(kitti(tmp_path, size=(40, 30)))
    camera = recording.calibrated
    assert (camera.model, camera.width, camera.fx, camera.distortion[0]) == ("radtan", 40, 35.0, -0.2)
    # Not rectified: the camera's own turn against camera 0, here about the optical axis, counts.
    assert roll_of(recording)[0] == pytest.approx(0.1 - 0.05)


def test_kitti_odometry(tmp_path: Path) -> None:
    folder = tmp_path / "dataset" / "sequences" / "07"
    for index in range(4):
        make_sets.save_image(folder / "image_2" / f"{index:06d}.png")
    (folder / "times.txt").write_text("0.0e+00\n1.0e-01\n2.0e-01\n3.0e-01\n")
    projection = "30 0 15.5 4 0 30 11.5 0 0 0 1 0"
    (folder / "calib.txt").write_text("".join(f"P{n}: {projection}\n" for n in range(4)))
    with pytest.raises(InputError, match=r"has no poses/07\.txt"):
        open_recording(folder)
    level = open_recording(folder, given=Given(attitude="constant:0,0"))
    np.testing.assert_allclose([h.up_cam for h in level.headers], [LEVEL] * 4, atol=1e-12)
    (tmp_path / "dataset" / "poses").mkdir()
    rows = []
    for index, roll in enumerate((0.1, -0.1, 0.1, -0.1)):
        turn = rotation_from_rpy(0.0, 0.0, roll)  # about the optical axis, clockwise
        rows.append(" ".join(map(str, np.column_stack([turn, [index, 0, 0]]).ravel())))
    (tmp_path / "dataset" / "poses" / "07.txt").write_text("\n".join(rows))
    recording = open_recording(folder)
    assert roll_of(recording) == pytest.approx([0.1, -0.1, 0.1, -0.1], abs=1e-9)
    assert "does not say where gravity pulls" in recording.notes[0]
    assert recording.headers[3].time_s == 0.3


def as_kalibr(sensor: Path) -> str:
    return (
        "cam0:\n  camera_model: pinhole\n  intrinsics: [30, 30, 15.5, 11.5]\n  resolution: [32, 24]\n"
        "  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n"
        "  T_cam_imu:\n  - [0, 1, 0, 0]\n  - [-1, 0, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n"
    )


@pytest.mark.parametrize("truth", ["state_groundtruth_estimate0", "mocap0", "gt", "vicon0"])
@pytest.mark.parametrize("below", ["", "mav0", "mav0/cam0"])
def test_euroc_ground_truths(tmp_path: Path, truth: str, below: str) -> None:
    root = make_sets.euroc(tmp_path, truth=True) / "mav0"
    (root / "state_groundtruth_estimate0").rename(root / truth)
    recording = open_recording(tmp_path / below)
    assert (recording.format, recording.notes) == ("euroc", ())
    np.testing.assert_allclose([h.up_cam for h in recording.headers], [LEVEL] * 3, atol=1e-9)


def test_euroc_columns_of_the_quaternion_are_found(tmp_path: Path) -> None:
    path = make_sets.euroc(tmp_path, truth=True) / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    half = np.sqrt(0.5)
    poses = [f"{50_000_000 * i},0,0,1,0,{-half},0,{half}" for i in range(40)]
    path.write_text("\n".join(["#timestamp [ns],px,py,pz,q_RS_x [],q_RS_y [],q_RS_z [],q_RS_w []", *poses]))
    for header in open_recording(tmp_path).headers:
        np.testing.assert_allclose(header.up_cam, LEVEL, atol=1e-9)


@pytest.mark.parametrize("where", ["mav0/cam0/camera.yaml", "camera.yaml", "dso/camchain.yaml", "--camera"])
def test_euroc_calibration_beside(tmp_path: Path, where: str) -> None:
    folder = make_sets.euroc(tmp_path / "set", truth=True)
    sensor = folder / "mav0" / "cam0" / "sensor.yaml"
    text = as_kalibr(sensor)
    sensor.unlink()
    path = tmp_path / "own.yaml" if where == "--camera" else folder / where
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    given = Given(camera=path) if where == "--camera" else Given()
    recording = open_recording(folder, given=given)
    np.testing.assert_allclose(recording.headers[0].up_cam, LEVEL, atol=1e-9)
    assert recording.notes == ()


def test_euroc_without_a_mount_takes_the_known_rig_or_asks(tmp_path: Path) -> None:
    folder = make_sets.euroc(tmp_path, truth=True)
    (folder / "mav0" / "cam0" / "sensor.yaml").unlink()
    plain = make_sets.CAMERA_YAML.replace("mount_rpy_deg: [0.0, 0.0, 0.0]\n", "")
    (folder / "mav0" / "cam0" / "camera.yaml").write_text(plain)
    recording = open_recording(folder)
    assert "EuRoC's own rig" in recording.notes[0]
    assert np.degrees(np.arccos(-recording.headers[0].up_cam[1])) < 2  # type: ignore[index]
    path = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    path.write_text("\n".join(["#t", *(f"{50_000_000 * i},0,0,1,1,0,0,0" for i in range(40))]))
    with pytest.raises(InputError, match="does not say how the camera sits on the IMU"):
        open_recording(folder)


def test_euroc_without_data_csv_takes_the_times_in_the_names(tmp_path: Path) -> None:
    (make_sets.euroc(tmp_path, truth=True) / "mav0" / "cam0" / "data.csv").unlink()
    recording = open_recording(tmp_path)
    assert [h.time_s for h in recording.headers] == pytest.approx([1.0, 1.1, 1.2])


@pytest.mark.parametrize("separator", [" ", "\t", "  ", ",", ", ", ";"])
@pytest.mark.parametrize("name", ["rgb.txt", "images.txt", "associations.txt", "associations-depth-first"])
def test_tum_lists(tmp_path: Path, separator: str, name: str) -> None:
    folder = make_sets.tum(tmp_path)
    lines = [line.split() for line in (folder / "rgb.txt").read_text().splitlines()[2:]]
    (folder / "rgb.txt").unlink()
    for _, image in lines:
        make_sets.save_image(folder / image.replace("rgb/", "depth/"), 640, 480, grey=True)
    if name.startswith("associations"):
        depth = [[time, image.replace("rgb/", "depth/")] for time, image in lines]
        first, second = (depth, lines) if "depth" in name else (lines, depth)
        lines = [[*a, *b] for a, b in zip(first, second, strict=True)]
        name = "associations.txt"
    text = "\n".join(separator.join(line) for line in lines)
    (folder / name).write_text("# freiburg3\n" + text)
    recording = open_recording(folder)
    assert [h.name.split("/")[0] for h in recording.headers] == ["rgb", "rgb"]
    np.testing.assert_allclose(recording.headers[0].up_cam, LEVEL, atol=1e-6)


def trajectory(folder: Path, rows: list[str], name: str = "groundtruth.txt") -> Path:
    make_sets.tum(folder)
    (folder / "groundtruth.txt").unlink()
    for index in range(len(rows)):
        make_sets.save_image(folder / "rgb" / f"{index}.png", 640, 480)
    (folder / "rgb.txt").write_text("".join(f"{i} rgb/{i}.png\n" for i in range(len(rows))))
    (folder / name).write_text("".join(f"{i} {row}\n" for i, row in enumerate(rows)))
    return folder


def test_world_with_y_up_by_number_of_frame(tmp_path: Path) -> None:
    # Camera x right, y down: turned by half a turn about x in a world with y up.
    folder = trajectory(tmp_path / "freiburg3", ["0 1.2 0 1 0 0 0"] * 6)
    recording = open_recording(folder)
    np.testing.assert_allclose([h.up_cam for h in recording.headers], [LEVEL] * 6, atol=1e-9)
    assert recording.headers[0].height_m == pytest.approx(1.2)
    assert recording.headers[3].time_s == pytest.approx(0.1)
    assert "y axis is taken as up" in " ".join(recording.notes)


def test_icl_nuim_camera_with_y_up(tmp_path: Path) -> None:
    folder = trajectory(tmp_path / "lr", ["0 1.2 0 0 0 0 1"] * 6, "livingRoom2.gt.freiburg")
    recording = open_recording(folder)
    np.testing.assert_allclose([h.up_cam for h in recording.headers], [LEVEL] * 6, atol=1e-9)
    assert (recording.calibrated.fx, recording.calibrated.fy) == (481.2, 480.0)
    pitched = [f"0 1.2 0 {math.sin(-0.1)} 0 0 {math.cos(-0.1)}"] * 6  # z tilts towards y: nose up by 0.2
    up = open_recording(trajectory(tmp_path / "p", pitched, "x.gt.freiburg")).headers[0].up_cam
    np.testing.assert_allclose(up, [0.0, -math.cos(0.2), math.sin(0.2)], atol=1e-9)


def test_trajectory_that_starts_in_its_first_camera(tmp_path: Path) -> None:
    half = 0.05
    rolled = f"1 0 2 0 0 {math.sin(half)} {math.cos(half)}"  # clockwise about the optical axis by 0.1
    folder = trajectory(tmp_path / "freiburg1", ["0 0 0 0 0 0 1", *[rolled] * 3])
    recording = open_recording(folder)
    assert roll_of(recording) == pytest.approx([0.0, 0.1, 0.1, 0.1])
    assert "starts in its first camera" in " ".join(recording.notes)


def test_world_with_y_down_is_named(tmp_path: Path) -> None:
    folder = make_sets.tum(tmp_path)
    poses = [f"{START_S + 0.01 * i:.4f} 1 2 3 0 0 0 1" for i in range(20)]
    (folder / "groundtruth.txt").write_text("\n".join(poses))
    assert "with its y axis down it would be" in open_recording(folder).notes[0]


def test_a_camera_that_looks_down_is_not_turned(tmp_path: Path) -> None:
    folder = make_sets.tum(tmp_path)
    poses = [f"{START_S + 0.01 * i:.4f} {0.01 * i} {0.1 * i} 30 1 0 0 0" for i in range(20)]  # flies north
    (folder / "groundtruth.txt").write_text("\n".join(poses))
    recording = open_recording(folder)
    np.testing.assert_allclose(recording.headers[0].up_cam, [0, 0, -1], atol=1e-9)
    assert "hardly ever upright" in recording.notes[0]


@pytest.mark.parametrize("side", ["left", "lcam_front"])
def test_tartanair(tmp_path: Path, side: str) -> None:
    folder = tmp_path / "P001"
    for index in range(3):
        make_sets.save_image(folder / f"image_{side}" / f"{index:06d}_{side}.png", 64, 48)
    (folder / f"depth_{side}").mkdir()
    depth = np.full((48, 64), 2.5, np.float32)
    depth[0] = np.inf
    np.save(folder / f"depth_{side}" / f"000000_{side}_depth.npy", depth)
    half = 0.1
    rows = [f"1 2 -3 {math.sin(half)} 0 0 {math.cos(half)}"] * 3  # rolled right side down by 0.2
    (folder / f"pose_{side}.txt").write_text("\n".join(rows))
    recording = open_recording(tmp_path)
    assert (recording.format, recording.calibrated.fx) == ("tartanair", 32.0)
    assert roll_of(recording) == pytest.approx([0.2] * 3)
    ranges = recording.read(0).ranges
    assert ranges is not None
    assert ranges.along == "axis"
    np.testing.assert_array_equal(ranges.metres[:2, 5], [np.nan, 2.5])
    assert recording.read(1).ranges is None
    (folder / f"pose_{side}.txt").write_text("\n".join(rows[:2]))
    with pytest.raises(InputError, match="2 poses for 3 images"):
        open_recording(tmp_path)


@pytest.mark.parametrize("depth", [1, 2, 3])
def test_nested_folders(tmp_path: Path, depth: int) -> None:
    inner = tmp_path.joinpath(*["more"] * depth)
    make_sets.images_csv(inner)
    (tmp_path / "readme.txt").write_text("hello")
    recording = open_recording(tmp_path)
    assert (recording.name, recording.format) == ("more", "images_csv")
    assert recording.read(0).image.shape == (24, 32, 3)


def test_several_recordings_below_are_named(tmp_path: Path) -> None:
    make_sets.images_csv(tmp_path / "a")
    make_sets.tum(tmp_path / "b")
    with pytest.raises(InputError, match="holds 2 recordings: a, b; give the folder of one of them"):
        open_recording(tmp_path)


@pytest.mark.parametrize("place", ["labels/images/a/1.png", "labels/a/1.png"])
def test_labels_of_images_of_one_name_in_two_folders(tmp_path: Path, place: str) -> None:
    rows = ["images/a/1.png,0,0,0,0,1", "images/b/1.png,0.1,0,0,0,1"]
    folder = make_sets.images_csv(tmp_path, rows)
    make_sets.save_image(folder / "labels" / "1.png", grey=True)  # whose is it?
    assert [h.labelled for h in open_recording(folder).headers] == [False, False]
    make_sets.save_image(folder / place, grey=True)
    assert [h.labelled for h in open_recording(folder).headers] == [True, False]


def test_labels_by_bare_stem_where_it_is_unique(tmp_path: Path) -> None:
    names = ["images/x/1.png", "images/y/2.jpg", "3.png", "3.jpg"]
    for stem in "123":
        make_sets.save_image(tmp_path / "labels" / f"{stem}.png", grey=True)
    one, two = (tmp_path / "labels" / f"{stem}.png" for stem in "12")
    assert files_beside(tmp_path, "labels", names) == [one, two, None, None]
    assert files_beside(tmp_path, "labels", ["1.png", "1.png"]) == [one, one]
    assert files_beside(tmp_path, "depth", names) == [None] * 4


def test_names_are_unique(tmp_path: Path) -> None:
    rows = ["a.png,0,0,0,0,1", "a.png,0.1,0,0,0,1", "b.png,0.2,0,0,0,1"]
    names = [h.name for h in open_recording(make_sets.images_csv(tmp_path, rows)).headers]
    assert names == ["a.png", "a.png#2", "b.png"]


def test_pictures_of_folders_by_the_numbers_in_their_names(tmp_path: Path) -> None:
    for name in ("a/f10.png", "a/f9.JPG", "b/f10.png"):
        make_sets.save_image((tmp_path / name).with_suffix(".png"))
        if name.endswith("JPG"):
            (tmp_path / name).with_suffix(".png").rename(tmp_path / name)
    recording = open_recording(tmp_path, given=Given(needs_attitude=False))
    assert [h.name for h in recording.headers] == ["a/f9.JPG", "a/f10.png", "b/f10.png"]


@pytest.mark.parametrize("option", ["attitude", "camera"])
def test_what_a_set_has_itself_is_not_given_in_silence(tmp_path: Path, option: str) -> None:
    folder = kitti(tmp_path)
    given = Given(attitude="constant:0,0") if option == "attitude" else Given(camera=tmp_path / "c.yaml")
    with pytest.raises(InputError, match=f"--{option} .*has no meaning for kitti"):
        open_recording(folder, given=given)


def test_given_attitude_and_camera_count_for_more_than_the_folder(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path / "set", ["a.png,10.0,,", "b.png,10.1,,"], "image,time_s,x,y")
    camera, log = tmp_path / "c.yaml", tmp_path / "log.csv"
    camera.write_text(make_sets.CAMERA_YAML.replace("fx: 30.0", "fx: 31.0"))
    log.write_text(
        "time,roll,pitch\n" + "\n".join(f"{i / 50};{i / 2};40".replace(";", ",") for i in range(50))
    )
    given = Given(camera=camera, attitude=str(log), time_offset_s=10.0)
    recording = open_recording(folder, given=given)
    assert recording.calibrated.fx == 31.0
    with pytest.raises(InputError, match="never meet"):
        open_recording(folder, given=Given(attitude=str(log)))
    constant = open_recording(folder, given=Given(attitude="constant:10,0"))
    assert roll_of(constant) == pytest.approx([math.radians(10)] * 2)
