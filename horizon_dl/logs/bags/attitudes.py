"""Topics that tell how something is turned against the world: read into one kind of series."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.logs.bags.frames import is_world, points_down
from horizon_dl.logs.bags.messages import NANOSECOND, decoder, frame_name, header_of
from horizon_dl.logs.bags.storage import Bag, Topic

Floats = NDArray[np.float64]

IMU = "sensor_msgs/msg/Imu"
PX4 = ("px4_msgs/msg/VehicleAttitude", "px4_msgs/msg/VehicleOdometry")
ALIGNED = 0.9
"""A force within 25 degrees of the vertical is gravity's, and tells which way the world's z points."""


@dataclass(frozen=True)
class Orientations:
    """A topic's attitudes.

    Attributes:
        topic: its name.
        kind: of its messages.
        frame: whose attitude it is; empty where the messages do not say.
        arrivals_s: (N,) when the recorder got them.
        stamps_s: (N,) by their headers, or as the arrivals where the headers say nothing.
        quaternions: (N, 4) unit, (w, x, y, z), the frame to the world; NaN where the topic gives none.
        rates: (N, 3) rad/s and `forces` (N, 3) m/s^2, of an IMU; else None.
        forces: see above.
        up_world: (3,) in the world of the quaternions.
        z_down: the frame's own axes are forward, right, down, as those of PX4 and of IMUs in such a world.
    """

    topic: str
    kind: str
    frame: str
    arrivals_s: Floats
    stamps_s: Floats
    quaternions: Floats
    rates: Floats | None = None
    forces: Floats | None = None
    up_world: tuple[float, float, float] = (0.0, 0.0, 1.0)
    z_down: bool = False

    @property
    def known(self) -> bool:
        """Whether the topic itself gives orientations, not only what an IMU feels."""
        return bool(np.isfinite(self.quaternions).all(axis=1).any())


def _ros(q: Any) -> tuple[float, ...]:
    return q.w, q.x, q.y, q.z


def _px4(q: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in q)


# Kind of message: its quaternion (w, x, y, z), and the frame whose attitude it is. Those whose vertical is
# gravity's come first; PX4's are the body's (FRD in NED), all others' are in a world with z up (REP 103).
Getter = Callable[[Any], tuple[tuple[float, ...], str]]
KINDS: dict[str, Getter] = {
    IMU: lambda m: (_ros(m.orientation), m.header.frame_id),
    "px4_msgs/msg/VehicleAttitude": lambda m: (_px4(m.q), ""),
    "px4_msgs/msg/VehicleOdometry": lambda m: (_px4(m.q), ""),
    "geometry_msgs/msg/QuaternionStamped": lambda m: (_ros(m.quaternion), m.header.frame_id),
    "nav_msgs/msg/Odometry": lambda m: (_ros(m.pose.pose.orientation), m.child_frame_id),
    "geometry_msgs/msg/PoseWithCovarianceStamped": lambda m: (_ros(m.pose.pose.orientation), ""),
    "geometry_msgs/msg/PoseStamped": lambda m: (_ros(m.pose.orientation), ""),
    "geometry_msgs/msg/TransformStamped": lambda m: (_ros(m.transform.rotation), m.child_frame_id),
}


def read_orientations(bag: Bag, topic: Topic) -> Orientations:
    """All of a topic's attitudes; some may be unknown."""
    get, decode = KINDS[topic.kind], decoder(bag, topic)
    is_imu, rows, frame, world = topic.kind == IMU, [], "", ""
    for arrival_ns, payload in bag.messages(topic):
        message = decode(payload)
        quaternion, frame = oriented(message, get)
        world = world_of(message)
        felt = (*_xyz(message.angular_velocity), *_xyz(message.linear_acceleration)) if is_imu else ()
        rows.append((arrival_ns * NANOSECOND, header_of(message)[0], *quaternion, *felt))
    table = np.array(rows, np.float64).reshape(len(rows), -1 if rows else 12)
    by = 1 if bool((table[:, 1] > 0).all()) else 0
    table = table[np.argsort(table[:, by], kind="stable")]
    found = Orientations(
        topic.name,
        topic.kind,
        frame,
        table[:, 0],
        table[:, by],
        _unit(table[:, 2:6]),
        table[:, 6:9] if is_imu else None,
        _in_m_s2(table[:, 9:12]) if is_imu else None,
        (0.0, 0.0, -1.0) if topic.kind in PX4 or points_down(world) else (0.0, 0.0, 1.0),
        topic.kind in PX4 or points_down(world),
    )
    return _with_checked_world(found) if is_imu and found.known else found


def oriented(message: Any, get: Getter) -> tuple[tuple[float, ...], str]:
    """Quaternion (w, x, y, z) and frame of a message; zeros where an IMU says that it knows none.

    A header that names a world says in which world something is turned, not what: the frame is the body's
    then, "". A child that is a world is turned in something else, which tells nothing: zeros.
    """
    quaternion, frame = get(message)
    frame = frame_name(frame)
    covariance = getattr(message, "orientation_covariance", (0.0,))
    nothing = covariance[0] == -1 or (hasattr(message, "child_frame_id") and is_world(frame))
    return (0.0, 0.0, 0.0, 0.0) if nothing else quaternion, "" if is_world(frame) else frame


def world_of(message: Any) -> str:
    """The world in which a message's pose is, as its header says; empty where its header is a sensor's."""
    return header_of(message)[1] if hasattr(message, "pose") or hasattr(message, "transform") else ""


def _xyz(vector: Any) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z


def _unit(quaternions: Floats) -> Floats:
    """At length one; NaN where they are none, and all of them where a driver repeats one it never sets."""
    norm = np.linalg.norm(quaternions, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        good = np.abs(norm - 1) < 0.1
    unit = np.where(good, quaternions / np.where(good, norm, 1.0), np.nan)
    repeats = len(unit) > 10 and bool((unit == unit[0]).all())
    return np.full_like(unit, np.nan) if repeats else unit


def _in_m_s2(forces: Floats) -> Floats:
    """Some drivers give accelerations in g, against the message's own definition."""
    usual = float(np.median(np.linalg.norm(forces, axis=1))) if len(forces) else 0.0
    return forces * 9.81 if 0.8 < usual < 1.2 else forces


def _with_checked_world(found: Orientations) -> Orientations:
    """Which way the world's z points, by the force of the ground: REP 103 says up, some drivers give NED.

    Where the force points to neither, the orientation is not one against gravity, and is not used.
    """
    assert found.forces is not None
    usable = np.isfinite(found.quaternions).all(axis=1) & np.isfinite(found.forces).all(axis=1)
    w, xyz = found.quaternions[usable, :1], found.quaternions[usable, 1:]
    force = found.forces[usable]
    # Rotation of many vectors by many quaternions: v + 2 w (u x v) + 2 u x (u x v).
    across = 2 * np.cross(xyz, force)
    mean = (force + w * across + np.cross(xyz, across)).mean(axis=0)
    size = float(np.linalg.norm(mean))
    if size < 2.0:  # gravity was taken out
        return found
    if abs(mean[2]) < ALIGNED * size:
        return replace(found, quaternions=np.full_like(found.quaternions, np.nan))
    return found if mean[2] > 0 else replace(found, up_world=(0.0, 0.0, -1.0), z_down=True)
