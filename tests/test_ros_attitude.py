"""Attitudes in bags: whose they are, in which world, and how the camera hangs on them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from make_bags import OPTICAL_IN_FLU, Maker, Rows, attitude_at, flight
from test_ros_bag import angle_deg

from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy
from horizon_dl.readers.registry import open_recording

pytest.importorskip("rosbags")

PX4 = {
    "px4_msgs/msg/VehicleAttitude": "uint64 timestamp\nuint64 timestamp_sample\nfloat32[4] q\n"
    "float32[4] delta_q_reset\nuint8 quat_reset_counter"
}
LEVEL = (0.0, -1.0, 0.0)


def ups_of(path: Path, **given: Any) -> np.ndarray:
    return np.array([header.up_cam for header in open_recording(path, given=Given(**given)).headers])


def pictures(maker: Maker, count: int = 8) -> tuple[Rows, np.ndarray]:
    """Only what is of the camera, and the up directions."""
    rows, _, ups = flight(maker, count)
    return [row for row in rows if row[0].startswith("/camera")], ups


def ros_q(time_s: float) -> list[float]:
    """FLU in ENU, (w, x, y, z)."""
    roll, pitch = attitude_at(time_s)
    values: list[float] = quaternion_from_rpy(roll, -pitch, 0.4).tolist()
    return values


def pose(maker: Maker, time_s: float, wxyz: list[float], child: str | None) -> Any:
    """Odometry where a child is given, else PoseStamped."""
    point = maker.new("geometry_msgs/msg/Point", x=0.0, y=0.0, z=0.0)
    where = maker.new("geometry_msgs/msg/Pose", position=point, orientation=maker.quaternion(wxyz))
    if child is None:
        return maker.new("geometry_msgs/msg/PoseStamped", header=maker.header(time_s, "map"), pose=where)
    still = maker.new("geometry_msgs/msg/Twist", linear=maker.xyz((0, 0, 0)), angular=maker.xyz((0, 0, 0)))
    return maker.new(
        "nav_msgs/msg/Odometry",
        header=maker.header(time_s, "odom"),
        child_frame_id=child,
        pose=maker.new("geometry_msgs/msg/PoseWithCovariance", pose=where, covariance=np.zeros(36)),
        twist=maker.new("geometry_msgs/msg/TwistWithCovariance", twist=still, covariance=np.zeros(36)),
    )


@pytest.mark.parametrize("child", ["base_link", None])
def test_odometry_and_poses_are_the_body_s(tmp_path: Path, child: str | None) -> None:
    maker = Maker()
    rows, ups = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "base_link", "cam", OPTICAL_IN_FLU)))
    rows += [("/pose", t, pose(maker, t, ros_q(t), child)) for t in np.arange(0, 0.8, 0.02)]
    assert angle_deg(ups_of(maker.write(tmp_path / "made", rows)), ups) < 0.1


def test_px4_is_forward_right_down(tmp_path: Path) -> None:
    maker = Maker(extra=PX4)
    rows, _ = pictures(maker)
    for t in np.arange(0, 0.8, 0.02):
        q = quaternion_from_rpy(*attitude_at(t), 0.4).astype(np.float32)
        micro = int(t * 1e6) + 5_000_000  # since boot: never meets the headers, so that arrival counts
        message = maker.new(
            "px4_msgs/msg/VehicleAttitude",
            timestamp=micro,
            timestamp_sample=micro,
            q=q,
            delta_q_reset=np.zeros(4, np.float32),
            quat_reset_counter=0,
        )
        rows.append(("/fmu/out/vehicle_attitude", t, message))
    camera = tmp_path / "camera.yaml"
    camera.write_text("model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n")
    path = maker.write(tmp_path / "made", rows)
    arrival = ups_of(path, camera=camera)[:-1]  # the pictures arrive 0.03 s after their headers
    expected = np.array(
        [
            [-np.sin(r) * np.cos(p), -np.cos(r) * np.cos(p), np.sin(p)]
            for r, p in (attitude_at(k * 0.1 + 0.03) for k in range(7))
        ]
    )
    assert angle_deg(arrival, expected) < 0.1
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "base_link", "cam", OPTICAL_IN_FLU)))
    assert angle_deg(ups_of(maker.write(tmp_path / "with_tf", rows))[:-1], expected) < 0.1


def imu_flight(maker: Maker, **change: Any) -> Rows:
    """The made flight, its IMU changed: `q` of a time, and how its forces are `turn`ed."""
    rows, _, _ = flight(maker)
    kept = [row for row in rows if row[0] != "/imu"]
    for topic, t, message in rows:
        if topic == "/imu":
            a = message.linear_acceleration
            force = np.array([a.x, a.y, a.z])
            q = change["q"](t) if "q" in change else ros_q(t)
            kept.append(("/imu", t, maker.imu(t, q, change.get("turn", np.eye(3)) @ force, frame="imu")))
    return kept


def test_a_world_with_z_down_is_told_by_gravity(tmp_path: Path) -> None:
    """A driver that gives FRD in NED, against REP 103; its frame's axes are in tf, its world is not."""
    maker = Maker()
    flip = np.diag([1.0, -1.0, -1.0])
    rows = imu_flight(maker, q=lambda t: quaternion_from_rpy(*attitude_at(t), 0.4).tolist(), turn=flip)
    frd = (0.5, 0.5, 0.5, 0.5)  # optical in FRD
    rows = [row for row in rows if row[0] != "/tf_static"]
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "imu", "cam", frd)))
    path = maker.write(tmp_path / "made", rows)
    assert angle_deg(ups_of(path), flight(maker)[2]) < 0.05
    assert any("z down" in note for note in open_recording(path).notes)


@pytest.mark.parametrize("scale", [1.0, 1 / 9.81])
@pytest.mark.parametrize("q", [lambda t: None, lambda t: [1, 0, 0, 0], lambda t: [0, 0, 0, 0]])
def test_without_an_orientation_the_imu_s_forces_tell(tmp_path: Path, q: Any, scale: float) -> None:
    """Said so by the covariance, never set, or zeros; forces in m/s^2, and in g as some drivers do."""
    maker = Maker()
    rows = [row for row in flight(maker)[0] if row[0] != "/imu"]
    up_flu = np.array([np.sin(-0.3), np.cos(0.3) * np.sin(0.2), np.cos(0.3) * np.cos(0.2)])
    rows += [("/imu", t, maker.imu(t, q(t), up_flu * 9.81 * scale)) for t in np.arange(0, 0.8, 0.01)]
    recording = open_recording(maker.write(tmp_path / "made", rows))
    assert any("gives no orientation" in note for note in recording.notes)
    ups = np.array([header.up_cam for header in recording.headers])
    assert angle_deg(ups, np.array([[-up_flu[1], -up_flu[2], up_flu[0]]] * len(ups))) < 0.01


def test_a_gimbal_turns_the_camera(tmp_path: Path) -> None:
    """The body rolls and pitches, the gimbal turns against it: the camera stays level."""
    maker = Maker()
    rows, _ = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "mount", "cam", OPTICAL_IN_FLU)))
    for t in np.arange(0, 0.8, 0.02):
        roll, pitch = attitude_at(t)
        q = quaternion_from_rpy(roll, -pitch, 0.0)
        rows.append(("/imu", t, maker.imu(t, q.tolist(), (0, 0, 0))))
        rows.append(("/tf", t, maker.transform(t, "imu", "mount", (q * [1, -1, -1, -1]).tolist())))
    recording = open_recording(maker.write(tmp_path / "made", rows))
    ups = np.array([header.up_cam for header in recording.headers])
    assert angle_deg(ups, np.array([LEVEL] * len(ups))) < 0.1
    assert recording.mount_rpy_rad is None


@pytest.mark.parametrize("root", ["odom", "robot1/map"])
def test_transforms_from_a_world_are_an_attitude(tmp_path: Path, root: str) -> None:
    maker = Maker()
    rows, ups = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "base_link", "cam", OPTICAL_IN_FLU)))
    rows += [("/tf", t, maker.transform(t, root, "base_link", ros_q(t))) for t in np.arange(0, 0.8, 0.02)]
    assert angle_deg(ups_of(maker.write(tmp_path / "made", rows)), ups) < 0.1


def test_transforms_within_the_robot_are_none(tmp_path: Path) -> None:
    maker = Maker()
    rows, _ = pictures(maker)
    rows += [("/tf", t, maker.transform(t, "base_link", "cam", ros_q(t))) for t in np.arange(0, 0.8, 0.02)]
    with pytest.raises(InputError, match="holds no attitude"):
        open_recording(maker.write(tmp_path / "made", rows))


def test_a_stated_mount_goes_before_tf(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, ups = flight(maker)
    camera = tmp_path / "camera.yaml"
    camera.write_text(
        "model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n"
        "mount_rpy_deg: [0, -10, 0]\n"
    )
    tilted = ups_of(maker.write(tmp_path / "made", rows), camera=camera)
    assert angle_deg(tilted, ups) == pytest.approx(10, abs=0.3)


def test_two_imus_are_asked_for(tmp_path: Path) -> None:
    maker = Maker()
    rows, _, _ = flight(maker)
    rows += [("/imu2", t, maker.imu(t, ros_q(t))) for t in np.arange(0, 0.8, 0.01)]
    path = maker.write(tmp_path / "made", rows)
    with pytest.raises(InputError, match=r"attitudes in /imu, /imu2; choose with --topic /imu"):
        open_recording(path)
    assert open_recording(path, given=Given(topics=("/imu2",))).notes[2] == "attitude of /imu2"


def test_a_stored_picture_is_turned_with_its_up(tmp_path: Path) -> None:
    maker = Maker()
    rows, seen, ups = flight(maker)
    camera = tmp_path / "camera.yaml"
    camera.write_text(
        "model: pinhole\nwidth: 24\nheight: 32\nfx: 30\nfy: 30\ncx: 11.5\ncy: 15.5\nrotate_image: 90ccw\n"
    )
    recording = open_recording(maker.write(tmp_path / "made", rows), given=Given(camera=camera))
    np.testing.assert_array_equal(recording.read(2).image, np.rot90(seen[2]))
    turned = np.column_stack([ups[:, 1], -ups[:, 0], ups[:, 2]])
    assert angle_deg(np.array([header.up_cam for header in recording.headers]), turned) < 0.05
