"""ROS bags against rosbags' own writers: every kind of file gives back what was written into it."""

import contextlib
import os
import pickle
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from make_bags import KINDS, Maker, attitude_at, flight

from horizon_dl.cli import main
from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.readers.registry import open_recording

pytest.importorskip("rosbags")


@pytest.fixture
def logs_dir() -> Path:
    folder = os.environ.get("HORIZON_DL_LOGS")
    if not folder:
        pytest.skip("HORIZON_DL_LOGS is not set")
    return Path(folder)


def angle_deg(first: np.ndarray, second: np.ndarray) -> float:
    """The largest angle between two lists of unit vectors."""
    return float(np.degrees(np.arccos(np.clip((first * second).sum(axis=-1), -1, 1))).max())


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_file_gives_back_what_was_written(tmp_path: Path, kind: str) -> None:
    maker = Maker(ros2=not kind.startswith("bag"))
    rows, pictures, ups = flight(maker)
    path = maker.write(tmp_path / "made", rows, kind)
    recording = open_recording(path)
    assert recording.format == "ros_bag"
    assert recording.camera is not None
    assert (recording.camera.width, recording.camera.fx) == (32, 30.0)
    assert recording.mount_rpy_rad == pytest.approx((0, 0, 0), abs=1e-6)
    assert angle_deg(np.array([header.up_cam for header in recording.headers]), ups) < 0.05
    for index in (5, 6, 2, 7, 0):
        np.testing.assert_array_equal(recording.read(index).image, pictures[index])
    copied = pickle.loads(pickle.dumps(recording))
    assert [frame.image.tobytes() for frame in copied.frames()] == [one.tobytes() for one in pictures]


@pytest.mark.parametrize("kind", ["db3", "mcap_message", "db3_message"])
def test_a_file_without_its_metadata(tmp_path: Path, kind: str) -> None:
    maker = Maker()
    rows, pictures, _ = flight(maker)
    folder = maker.write(tmp_path / "made", rows, kind)
    (folder / "metadata.yaml").unlink()
    for path in (folder, next(folder.iterdir())):
        np.testing.assert_array_equal(open_recording(path).read(3).image, pictures[3])


def test_times_are_the_headers_and_the_offset_is_the_logs(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, ups = flight(maker)
    path = maker.write(tmp_path / "made", rows)
    times = [header.time_s for header in open_recording(path).headers]
    np.testing.assert_allclose(np.diff(times), 0.1, atol=1e-6)
    shifted = open_recording(path, given=Given(time_offset_s=0.1)).headers
    assert shifted[0].up_cam is None
    assert angle_deg(np.array([one.up_cam for one in shifted[1:]]), ups[:-1]) < 0.05


def test_headers_without_stamps_go_by_arrival(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, _ = flight(maker)
    for _, _, message in rows:
        if hasattr(message, "header"):
            message.header.stamp.sec = message.header.stamp.nanosec = 0
    headers = open_recording(maker.write(tmp_path / "made", rows)).headers
    assert headers[0].time_s == pytest.approx(1_700_000_000.03)
    assert headers[3].up_cam is not None


def test_two_cameras_are_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    maker = Maker()
    rows, pictures, _ = flight(maker)
    left = [("/left/image_raw", t, m) for topic, t, m in rows if topic == "/camera/image_raw"]
    path = maker.write(tmp_path / "made", [*rows, *left])
    with pytest.raises(InputError, match=r"pictures in /left/image_raw, /camera/image_raw"):
        open_recording(path)
    chosen = open_recording(path, given=Given(topics=("/left/image_raw",)))
    np.testing.assert_array_equal(chosen.read(1).image, pictures[1])
    assert main(["check-data", str(path), "--topic", "/camera/image_raw"]) == 0
    capsys.readouterr()
    assert main(["check-data", str(path), "--topic", "/camera"]) == 2
    assert "--topic /camera: is not in the bag; choose from" in capsys.readouterr().err


def test_the_same_pictures_sent_twice_and_depth_are_no_second_camera(tmp_path: Path) -> None:
    maker = Maker()
    rows, pictures, _ = flight(maker)
    depth = np.full((24, 32), 900, np.uint16)
    for index in range(len(pictures)):
        compressed = maker.compressed(index * 0.1, pictures[index])
        rows.append(("/camera/image_raw/compressed", index * 0.1, compressed))
        rows.append(("/camera/depth/image_raw", index * 0.1, maker.image(index * 0.1, depth, "16UC1")))
    recording = open_recording(maker.write(tmp_path / "made", rows))
    assert recording.notes[0] == "pictures of /camera/image_raw"


def test_what_is_missing_is_said(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, ups = flight(maker)

    def without(*topics: str) -> Path:
        name = "_".join(topics).replace("/", "")
        return maker.write(tmp_path / name, [row for row in rows if row[0] not in topics])

    camera = tmp_path / "camera.yaml"
    camera.write_text("model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n")
    with pytest.raises(InputError, match="no CameraInfo goes with /camera/image_raw; give --camera FILE"):
        open_recording(without("/camera/camera_info"))
    with pytest.raises(InputError, match="no tf joins them; give --camera FILE with mount_rpy_deg"):
        open_recording(without("/tf_static"))
    mounted = open_recording(tmp_path / "tf_static", given=Given(camera=camera))
    assert angle_deg(np.array([header.up_cam for header in mounted.headers]), ups) < 0.05
    with pytest.raises(InputError, match="holds no attitude"):
        open_recording(without("/imu"))
    assert open_recording(tmp_path / "imu", given=Given(needs_attitude=False)).length == 8
    with pytest.raises(InputError, match=r"holds no pictures, only sensor_msgs/msg/CameraInfo"):
        open_recording(without("/camera/image_raw"))


def test_a_log_beside_the_bag_is_read_as_its_options_say(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, ups = flight(maker)
    path = maker.write(tmp_path / "bag", [row for row in rows if row[0] != "/imu"])
    (tmp_path / "camera.yaml").write_text(
        "model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n"
    )
    times_s = [k / 100 for k in range(100)]
    cells = [",".join(map(str, (time_s, *attitude_at(time_s)))) for time_s in times_s]
    (tmp_path / "log.csv").write_text("\n".join(["time_s,roll,pitch", *cells]))
    given = Given(
        camera=tmp_path / "camera.yaml", attitude=str(tmp_path / "log.csv"), time_offset_s=1_700_000_000.0
    )
    with pytest.raises(InputError, match="--angle-unit rad"):
        open_recording(path, given=given)
    recording = open_recording(path, given=replace(given, angle_unit="rad"))
    assert angle_deg(np.array([header.up_cam for header in recording.headers]), ups) < 0.05


def test_the_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    maker = Maker(ros2=False)
    path = maker.write(tmp_path / "made", flight(maker)[0], "bag")
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(InputError, match=r"install horizon-dl\[logs\]"):
        open_recording(path)


@pytest.mark.parametrize("kind", ["bag", "bag_lz4", "bag_bz2", "db3", "mcap", "mcap_storage"])
def test_damage_ends_in_one_line_and_soon(tmp_path: Path, kind: str) -> None:
    maker = Maker(ros2=not kind.startswith("bag"))
    made = maker.write(tmp_path / "made", flight(maker, 3)[0], kind)
    file = made if made.is_file() else next(one for one in made.iterdir() if one.suffix != ".yaml")
    whole = file.read_bytes()
    rng = np.random.default_rng(1)
    damaged = tmp_path / f"damaged{file.suffix}"
    begin = time.monotonic()
    for attempt in range(30):
        content = bytearray(whole[: rng.integers(0, len(whole))] if attempt % 3 == 0 else whole)
        for place in rng.integers(0, max(len(content), 1), 20 * (attempt % 3)):
            content[place] = rng.integers(0, 256)
        damaged.write_bytes(content)
        with contextlib.suppress(InputError):  # whatever it is, it is no other exception
            list(open_recording(damaged).frames())
    assert time.monotonic() - begin < 60
    damaged.write_bytes(b"")
    with pytest.raises(InputError):
        open_recording(damaged)


@pytest.mark.parametrize("name", ["rpy.bag", "rpy_db3", "rpy_mcap", "rpy_db3/rpy_db3.db3"])
def test_the_made_sample_agrees_with_the_set_it_was_made_of(
    logs_dir: Path, data_dir: Path, name: str
) -> None:
    recording = open_recording(logs_dir / "ros_made" / name)
    truth = open_recording(data_dir / "tum_fr1_rpy")
    # Every fifth picture of the one is every third of the other, from the one's frame 20 on.
    mine = np.array([recording.headers[index].up_cam for index in range(0, 40, 5)])
    theirs = np.array([truth.headers[index].up_cam for index in range(20, 44, 3)])
    assert angle_deg(mine, theirs) < 0.2


def test_zstd_that_only_the_metadata_states(logs_dir: Path) -> None:
    path = logs_dir / "mcap_ros2" / "soccer_goal_12.mcap"
    recording = open_recording(path, given=Given(needs_attitude=False))
    assert recording.length == 2
    assert np.std(recording.read(1).image) > 5
    with pytest.raises(InputError, match="no CameraInfo"):
        open_recording(path)


def test_a_bag_without_a_camera(logs_dir: Path) -> None:
    with pytest.raises(InputError, match="holds no pictures, only"):
        open_recording(logs_dir / "rosbag1" / "example-bz2.bag")
