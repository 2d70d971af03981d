"""Recordings a little other than those that are read, as drivers and apps write them: right, or told."""

import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import make_sets
import numpy as np
import pytest
from make_bags import OPTICAL_IN_FLU, Maker, Rows, attitude_at, flight
from PIL import Image
from test_attitude_logs import phone_folder, rpy_deg
from test_ros_attitude import pictures, pose, ros_q, ups_of
from test_ros_bag import angle_deg

from horizon_dl.cli import main
from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import Given
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy
from horizon_dl.logs.attitude_logs.registry import read_attitude_log
from horizon_dl.logs.bags.pixels import bits_of, picture
from horizon_dl.logs.log_recording import headers_by_log
from horizon_dl.readers.registry import open_recording

CAMERA = "model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n"
TIMES = np.arange(0, 0.8, 0.02)


@pytest.fixture
def camera(tmp_path: Path) -> Path:
    path = tmp_path / "camera.yaml"
    path.write_text(CAMERA)
    return path


def with_base(maker: Maker) -> tuple[Rows, np.ndarray]:
    """Pictures of a camera in the robot, and their up directions."""
    rows, ups = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "base_link", "cam", OPTICAL_IN_FLU)))
    return rows, ups


def notes_of(path: Path, **given: Any) -> str:
    return " ".join(open_recording(path, given=Given(**given)).notes)


def doubts_of(path: Path) -> str:
    return " ".join(note for note in open_recording(path).notes if isinstance(note, Doubt))


def test_a_header_that_names_a_world_says_not_what_is_turned(tmp_path: Path) -> None:
    """Imu and QuaternionStamped with frame `map` beside a tf that has the same tilt: not applied twice."""
    maker = Maker()
    rows, ups = with_base(maker)
    rows += [("/tf", t, maker.transform(t, "map", "base_link", ros_q(t))) for t in TIMES]
    for t in TIMES:
        turned = maker.new(
            "geometry_msgs/msg/QuaternionStamped",
            header=maker.header(t, "map"),
            quaternion=maker.quaternion(ros_q(t)),
        )
        rows.append(("/attitude", t, turned))
    assert angle_deg(ups_of(maker.write(tmp_path / "stamped", rows)), ups) < 0.1
    rows = [row for row in rows if row[0] != "/attitude"]
    roll_pitch = [attitude_at(t) for t in TIMES]
    forces = [
        np.array([np.sin(p), np.sin(r) * np.cos(p), np.cos(r) * np.cos(p)]) * 9.81 for r, p in roll_pitch
    ]
    rows += [("/imu", t, maker.imu(t, ros_q(t), f, frame="map")) for t, f in zip(TIMES, forces, strict=True)]
    assert angle_deg(ups_of(maker.write(tmp_path / "imu", rows)), ups) < 0.1


def test_a_driver_that_knows_its_orientation_a_little_later_is_still_first(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, ups = flight(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "base_link", "imu", (1, 0, 0, 0))))
    imu = [row for row in rows if row[0] == "/imu"]
    rows = [row for row in rows if row[0] != "/imu"]
    early = [("/imu", t - 0.1, maker.imu(t - 0.1 + 1e-3, None)) for _, t, _ in imu[:5]]
    flat = [("/odom", t, pose(maker, t, [np.cos(t), 0, 0, np.sin(t)], "base_link")) for t in TIMES]
    path = maker.write(tmp_path / "made", [*rows, *early, *imu, *flat])
    assert "attitude of /imu" in notes_of(path)
    assert angle_deg(ups_of(path)[1:], ups[1:]) < 0.1


def test_two_parents_of_a_frame_are_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    maker = Maker()
    rows, _ = with_base(maker)
    rows += [("/tf", t, maker.transform(t, "odom", "base_link", ros_q(t))) for t in TIMES]
    rows += [("/tf", t + 1e-3, maker.transform(t, "world", "base_link", ros_q(t))) for t in TIMES]
    path = maker.write(tmp_path / "made", rows)
    assert "two parents, odom and world" in doubts_of(path)
    assert main(["check-data", str(path)]) == 0
    assert "warning  Tf gives base_link two parents" in capsys.readouterr().out


def moving_imu(
    maker: Maker,
    accelerometer: str,
    gyroscope: str,
    frame: str = "imu",
    turn: np.ndarray | None = None,
    until_s: float = 1.0,
) -> tuple[Rows, np.ndarray]:
    """Pictures of a camera in an IMU that gives rates and forces alone, in one topic or apart.

    The accelerometer has axes of its own, `turn`ed, in `frame`, and ends earlier.
    """
    rows, ups = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "imu", "cam", OPTICAL_IN_FLU)))
    step = 1e-4
    for t in np.arange(-0.01, 0.8, 0.01):
        (roll, pitch), (later_roll, later_pitch) = attitude_at(t), attitude_at(t + step)
        roll_rate, pitch_rate = (later_roll - roll) / step, (later_pitch - pitch) / step
        # FRD rates of a fixed heading, then FLU.
        rate = np.array([roll_rate, -pitch_rate * np.cos(roll), pitch_rate * np.sin(roll)])
        force = np.array([np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)]) * 9.81
        if accelerometer == gyroscope:
            rows.append((gyroscope, t, maker.imu(t, None, force, rate)))
        else:
            if t <= until_s:
                own = force if turn is None else turn @ force
                rows.append((accelerometer, t, maker.imu(t, None, own, (0, 0, 0), frame)))
            rows.append((gyroscope, t, maker.imu(t + 2e-3, None, (0, 0, 0), rate)))
    return rows, ups


@pytest.mark.parametrize("named", [(), ("/accel/sample", "/gyro/sample")])
def test_a_gyroscope_and_an_accelerometer_apart_are_one_imu(tmp_path: Path, named: tuple[str, ...]) -> None:
    maker = Maker()
    rows, ups = moving_imu(maker, "/accel/sample", "/gyro/sample")
    path = maker.write(tmp_path / "made", rows)
    assert angle_deg(ups_of(path, topics=named), ups) < 1.0
    assert "/gyro/sample and /accel/sample" in notes_of(path, topics=named)


def test_an_accelerometer_with_axes_of_its_own_is_turned_by_tf(tmp_path: Path) -> None:
    maker, quarter = Maker(), np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])
    rows, ups = moving_imu(maker, "/accel", "/gyro", "accel", quarter)
    with pytest.raises(InputError, match="no tf joins them"):
        open_recording(maker.write(tmp_path / "alone", rows))
    # From the accelerometer's axes to the IMU's: the transpose, a quarter turn about x.
    half = float(np.sqrt(0.5))
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "imu", "accel", (half, half, 0, 0))))
    assert angle_deg(ups_of(maker.write(tmp_path / "joined", rows)), ups) < 1.0


def test_where_the_accelerometer_ended_nothing_is_known(tmp_path: Path) -> None:
    maker = Maker()
    rows, ups = moving_imu(maker, "/accel", "/gyro", until_s=0.4)
    found = [header.up_cam for header in open_recording(maker.write(tmp_path / "made", rows)).headers]
    assert all(up is not None for up in found[:4])
    assert all(up is None for up in found[7:])
    assert angle_deg(np.array(found[:4]), ups[:4]) < 2.0


def test_a_damaged_picture_is_left_out_and_no_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    maker = Maker()
    rows, _, _ = flight(maker)
    serialize, count = maker.store.serialize_cdr, [0]

    def cut(message: Any, name: str) -> Any:
        data = serialize(message, name)
        count[0] += name.endswith("msg/Image")
        return data[:60] if name.endswith("msg/Image") and count[0] == 1 else data

    monkeypatch.setattr(maker.store, "serialize_cdr", cut)
    recording = open_recording(maker.write(tmp_path / "made", rows))
    with pytest.raises(FrameError):
        recording.read(0)
    assert recording.read(1).image.shape == (24, 32, 3)


def test_where_nothing_can_be_read_the_reason_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    maker = Maker()
    path = maker.write(tmp_path / "made", flight(maker)[0])
    break_topic(monkeypatch, "/imu")
    with pytest.raises(InputError, match="has a broken definition"):
        open_recording(path)


def test_an_imu_that_starts_under_way_is_right_from_the_start(tmp_path: Path) -> None:
    maker = Maker()
    rows, ups = moving_imu(maker, "/imu", "/imu")
    assert angle_deg(ups_of(maker.write(tmp_path / "made", rows)), ups) < 0.5


def test_forces_without_gravity_tell_no_attitude(tmp_path: Path) -> None:
    maker = Maker()
    rows = [row for row in flight(maker)[0] if row[0] != "/imu"]
    rng = np.random.default_rng(0)
    rows += [("/imu", t, maker.imu(t, None, rng.normal(0, 0.2, 3))) for t in np.arange(0, 0.8, 0.01)]
    path = maker.write(tmp_path / "made", rows)
    with pytest.raises(InputError, match="holds no attitude"):
        open_recording(path)


@pytest.mark.parametrize("with_q", [True, False])
def test_an_imu_that_points_down_is_on_forward_right_down(tmp_path: Path, camera: Path, with_q: bool) -> None:
    """FRD in NED, and nothing but a camera file with a mount of zero: the camera looks along its x."""
    maker = Maker()
    rows, ups = pictures(maker)
    for t in TIMES:
        roll, pitch = attitude_at(t) if with_q else attitude_at(0.0)
        force = -9.81 * np.array([-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)])
        q = quaternion_from_rpy(roll, pitch, 0.4).tolist() if with_q else None
        rows.append(("/imu", t, maker.imu(t, q, force)))
    found = ups_of(maker.write(tmp_path / "made", rows), camera=camera)
    assert angle_deg(found, ups if with_q else np.array([ups[0]] * len(ups))) < 0.1


@pytest.mark.parametrize("topic", ["tf", "odometry"])
def test_a_world_whose_name_says_ned_points_down(tmp_path: Path, topic: str) -> None:
    maker = Maker()
    rows, ups = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "drone", "cam", (0.5, 0.5, 0.5, 0.5))))
    for t in TIMES:
        q = quaternion_from_rpy(*attitude_at(t), 0.4).tolist()
        if topic == "tf":
            rows.append(("/tf", t, maker.transform(t, "world_ned", "drone", q)))
        else:
            odometry = pose(maker, t, q, "drone")
            odometry.header.frame_id = "world_ned"
            rows.append(("/odom", t, odometry))
    assert angle_deg(ups_of(maker.write(tmp_path / "made", rows)), ups) < 0.1


@pytest.mark.parametrize("apart_s", [0.0, 1.0, 5.0])
def test_stamps_of_two_clocks_are_told(tmp_path: Path, apart_s: float) -> None:
    maker = Maker()
    rows, _, _ = flight(maker, 80)
    for topic, _, message in rows:
        if topic.startswith("/camera"):
            message.header.stamp.sec += int(apart_s)
    said = doubts_of(maker.write(tmp_path / "made", rows))
    assert ("one clock may be wrong" in said) == (apart_s > 0)


def break_topic(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Nothing can be made of a topic's messages."""
    from horizon_dl.logs.bags import choose

    decoder = choose.decoder

    def broken(bag: Any, topic: Any) -> Any:
        if topic.name == name:
            raise InputError(bag.path, "has a broken definition", "copy it again")
        return decoder(bag, topic)

    monkeypatch.setattr(choose, "decoder", broken)


def test_a_topic_that_cannot_be_read_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    maker = Maker()
    rows, _, ups = flight(maker)
    rows += [("/odom", t, pose(maker, t, ros_q(t), "base_link")) for t in TIMES]
    path = maker.write(tmp_path / "made", rows)
    break_topic(monkeypatch, "/odom")
    assert angle_deg(ups_of(path), ups) < 0.1


def test_the_first_picture_may_be_broken(tmp_path: Path) -> None:
    maker = Maker()
    rows, written, ups = flight(maker)
    rows = [row for row in rows if row[0] != "/camera/image_raw"]
    for index, pixels in enumerate(written):
        message = maker.compressed(index * 0.1, pixels)
        if index == 0:
            message.data = message.data[:20]
        rows.append(("/camera/image_raw/compressed", index * 0.1 + 0.03, message))
    recording = open_recording(maker.write(tmp_path / "made", rows))
    assert angle_deg(np.array([header.up_cam for header in recording.headers]), ups) < 0.1
    np.testing.assert_array_equal(recording.read(3).image, written[3])


def test_a_dark_first_picture_does_not_tell_the_bits(tmp_path: Path) -> None:
    maker = Maker()
    rows, written, _ = flight(maker)
    rows = [row for row in rows if row[0] != "/camera/image_raw"]
    for index, pixels in enumerate(written):
        grey = pixels[..., 0].astype(np.uint16) * (0 if index == 0 else 256)
        rows.append(("/camera/image_raw", index * 0.1, maker.image(index * 0.1, grey, "mono16")))
    recording = open_recording(maker.write(tmp_path / "made", rows))
    np.testing.assert_array_equal(recording.read(3).image[..., 0], written[3][..., 0])


def test_a_compressed_picture_of_12_bits_is_as_bright_as_a_raw_one() -> None:
    values = np.arange(4096, dtype=np.uint16).reshape(64, 64)
    file = io.BytesIO()
    Image.fromarray(values).save(file, "PNG")
    message = SimpleNamespace(format="mono16; png compressed ", data=np.frombuffer(file.getvalue(), np.uint8))
    assert bits_of(message) == 12
    np.testing.assert_array_equal(picture(message, "a", 12)[..., 0], values >> 4)


def text_log(path: Path, rows: list[str], camera: str = "Roll,Pitch,Yaw") -> Path:
    formats = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 10, 30, ATT, Qfff, TimeUS,Roll,Pitch,Yaw",
        "FMT, 12, 30, AHR2, Qfff, TimeUS,Roll,Pitch,Yaw",
        f"FMT, 11, 30, CAM, Qfff, TimeUS,{camera}",
    ]
    path.write_text("\n".join([*formats, *rows]) + "\n")
    return path


def test_camera_rows_have_two_spellings(tmp_path: Path) -> None:
    rows = [f"ATT, {1000000 + 100000 * n}, {n}, 1.5, 359.0" for n in range(10)]
    log = read_attitude_log(text_log(tmp_path / "a.log", [*rows, "CAM, 1450000, 4.6, 1.4, 358.0"], "R,P,Y"))
    assert log.shutter is not None
    assert rpy_deg(log.shutter)[0] == pytest.approx([4.6, 1.4, -2.0], abs=1e-4)


def test_the_second_estimate_serves_where_the_first_is_not_logged(tmp_path: Path) -> None:
    rows = [f"AHR2, {1000000 + 100000 * n}, {n}, 1.5, 359.0" for n in range(10)]
    log = read_attitude_log(text_log(tmp_path / "a.log", rows))
    assert rpy_deg(log)[3] == pytest.approx([3.0, 1.5, -1.0], abs=1e-4)
    assert "AHR2" in log.notes[0]


def test_another_number_of_photos_than_the_log_has_is_told(tmp_path: Path, camera: Path) -> None:
    for index in range(5):
        make_sets.save_image(tmp_path / "set" / f"{1700000000 + index}.png", 32, 24)
    rows = [f"ATT, {1000000 + 100000 * n}, {n}, 1.5, 359.0" for n in range(10)]
    rows += [f"CAM, {1400000 + n}, 4.6, 1.4, 358.0" for n in range(4)]
    log = text_log(tmp_path / "a.log", rows)
    with pytest.raises(InputError, match="holds 5 pictures, and the log tells of 4 that were taken"):
        open_recording(tmp_path / "set", given=Given(camera, str(log)))


def test_a_log_with_gps_time_meets_pictures_named_by_the_clock() -> None:
    """Boot at 1.7e9 less 10 s: without the GPS's word the two never meet."""
    times_s = 10.0 + np.arange(0, 5, 0.01)
    q = np.array([quaternion_from_rpy(0.0, 0.01 * t, 0.0) for t in times_s])
    log = AttitudeLog(times_s, q, unix_start_s=1.7e9)
    calibration = SimpleNamespace(mount_rpy_rad=(0.0, 0.0, 0.0))
    frames = [1.7e9 + 2.0, 1.7e9 + 3.0]
    headers, _, notes = headers_by_log(Path("x"), ["a", "b"], frames, calibration, log, Given())  # type: ignore[arg-type]
    # Up of a camera that is pitched by p: z = sin(p).
    assert [float(header.up_cam[2]) for header in headers if header.up_cam is not None] == pytest.approx(
        [np.sin(0.12), np.sin(0.13)], abs=1e-6
    )
    assert any("GPS" in note for note in notes)
    with pytest.raises(InputError, match="never meet"):
        headers_by_log(
            Path("x"),
            ["a", "b"],
            frames,
            calibration,  # type: ignore[arg-type]
            AttitudeLog(times_s, q),
            Given(),
        )


@pytest.mark.parametrize("name", ["a.ulg", "a.BIN"])
@pytest.mark.parametrize("content", [b"", b"\x00garbage" * 40])
def test_a_file_that_only_has_the_name_of_a_log(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=rf"{name}: .*; copy it again"):
        read_attitude_log(tmp_path / name)


ORIENTATION = (
    "time,seconds_elapsed,qz,qy,qx,qw\n1700000000000000000,0,0,0,0,1\n1700000000010000000,0.01,0,0,0,1\n"
)


def test_sensor_loggers_orientation_is_not_taken_for_a_bodys(tmp_path: Path) -> None:
    alone = tmp_path / "Orientation.csv"
    alone.write_text(ORIENTATION)
    with pytest.raises(InputError, match=r"has no Gravity.csv"):
        read_attitude_log(alone)
    folder = phone_folder(tmp_path / "export", "platform,standardisation\nandroid,false\n", 1.0)
    (folder / "Orientation.csv").write_text(ORIENTATION)
    assert rpy_deg(read_attitude_log(folder / "Orientation.csv"))[0] == pytest.approx([0, -9.98, 0], abs=0.01)


def test_pictures_of_a_phone_find_their_attitude(tmp_path: Path, camera: Path) -> None:
    folder = phone_folder(tmp_path / "export", "platform,standardisation\nandroid,false\n", 1.0)
    for index in range(3):
        make_sets.save_image(folder / "Camera" / f"{1700000000000 + 50 * index}.jpg", 32, 24)
    recording = open_recording(folder, given=Given(camera))
    assert [header.up_cam is not None for header in recording.headers] == [True] * 3
    with pytest.raises(InputError, match="does not tell its camera; give it with --camera"):
        open_recording(folder)
    (folder / "Camera" / "camera.yaml").write_text(CAMERA)
    assert open_recording(folder).length == 3


def test_without_metadata_the_sign_is_in_doubt(tmp_path: Path) -> None:
    folder = phone_folder(tmp_path / "export", "", 1.0)
    (folder / "Metadata.csv").unlink()
    (doubt,) = read_attitude_log(folder).notes
    assert isinstance(doubt, Doubt)
    assert "wrong sign" in doubt


def test_a_phone_without_a_focal_length_says_so(tmp_path: Path) -> None:
    from horizon_dl.readers.mars import _own_camera

    with pytest.raises(InputError, match="is missing; restore it, or give the camera with --camera"):
        _own_camera(tmp_path, tmp_path / "movie.mp4")
    (tmp_path / "movie_metadata.csv").write_text("Timestamp[nanosec],fx[px],fy[px]\n1,0,0\n")
    with pytest.raises(InputError, match="tells no focal length"):
        _own_camera(tmp_path, tmp_path / "movie.mp4")
