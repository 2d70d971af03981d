"""Attitudes as unit quaternions (w, x, y, z), body FRD to world NED, and where "up" lies in a camera.

Frames: world NED (north, east, down); body FRD (forward, right, down); camera optical (right, down, forward).
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Rows are the optical axes (right, down, forward) written in FRD.
OPTICAL_FROM_FRD = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
UP_NED = np.array([0.0, 0.0, -1.0])
MountRpy = tuple[float, float, float]
"""Roll, pitch and yaw of a camera in the body, rad."""

MAX_GAP_S = 0.2
"""Longest gap between two attitude samples that is bridged; robots turn too much in longer ones."""


def quaternion_from_rpy(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """Quaternion (w, x, y, z) of the aerospace angles `Rz(yaw) Ry(pitch) Rx(roll)`, rad.

    Signs: roll > 0 right side down, pitch > 0 nose up, yaw > 0 clockwise seen from above.

    Example:
        >>> quaternion_from_rpy(0.0, 0.0, 0.0).tolist()
        [1.0, 0.0, 0.0, 0.0]
    """
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def rotation_from_quaternion(q: ArrayLike) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) body to world of a quaternion (w, x, y, z) of any length but zero.

    Raises:
        ValueError: the quaternion is zero or not finite.
    """
    w, x, y, z = _of_length_one(q, "not a rotation: quaternion").tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) `Rz(yaw) Ry(pitch) Rx(roll)`, rad."""
    return rotation_from_quaternion(quaternion_from_rpy(roll, pitch, yaw))


def rpy_from_rotation(rotation: ArrayLike) -> tuple[float, float, float]:
    """Roll, pitch, yaw (rad) of a rotation matrix; undoes `rotation_from_rpy` for |pitch| < pi/2.

    Straight up or down roll and yaw turn about one axis: there the roll is zero.
    """
    r = np.asarray(rotation, dtype=np.float64)
    pitch = math.asin(max(-1.0, min(1.0, -float(r[2, 0]))))
    if math.hypot(float(r[2, 1]), float(r[2, 2])) < 1e-9:
        return 0.0, pitch, math.atan2(-r[0, 1], r[1, 1])
    return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])


def yaw_of(attitude_q: ArrayLike) -> float:
    """Yaw (rad) of an attitude (w, x, y, z): clockwise seen from above.

    Example:
        >>> round(yaw_of(quaternion_from_rpy(0.1, -0.2, 0.7)), 6)
        0.7
    """
    return rpy_from_rotation(rotation_from_quaternion(attitude_q))[2]


def slerp(q0: ArrayLike, q1: ArrayLike, fraction: float) -> NDArray[np.float64]:
    """Unit quaternion at `fraction` in [0, 1] of the shorter arc from q0 to q1 (Shoemake 1985)."""
    a, b = (np.asarray(q, dtype=np.float64) / np.linalg.norm(q) for q in (q0, q1))
    dot = float(a @ b)
    if dot < 0:  # q and -q are the same rotation: take the one that is nearer
        b, dot = -b, -dot
    if dot > 0.9995:  # nearly equal: the sine in the denominator vanishes
        mixed = a + fraction * (b - a)
    else:
        angle = math.acos(min(dot, 1.0))
        mixed = math.sin((1 - fraction) * angle) * a + math.sin(fraction * angle) * b
    unit: NDArray[np.float64] = mixed / np.linalg.norm(mixed)
    return unit


def bracket(times_s: NDArray[np.float64], time_s: float, max_gap_s: float) -> tuple[int, float] | None:
    """Index i and fraction in [0, 1] so that time_s lies that far from sample i to sample i + 1.

    Args:
        times_s: (N,) sorted, s.
        time_s: s.
        max_gap_s: longest distance between two samples that is bridged, s.

    Returns:
        None outside of the samples and in gaps longer than `max_gap_s`.
    """
    if len(times_s) == 0 or not times_s[0] <= time_s <= times_s[-1]:
        return None
    after = int(np.searchsorted(times_s, time_s, side="left"))
    if times_s[after] == time_s:
        return (after, 0.0) if after + 1 < len(times_s) else (max(after - 1, 0), 1.0 if after else 0.0)
    span = float(times_s[after] - times_s[after - 1])
    if span > max_gap_s:
        return None
    return after - 1, (time_s - float(times_s[after - 1])) / span


def interpolate(
    times_s: NDArray[np.float64], quaternions: NDArray[np.float64], time_s: float, max_gap_s: float
) -> NDArray[np.float64] | None:
    """Attitude at a time by spherical interpolation along the shorter arc.

    Args:
        times_s: (N,) sorted, s.
        quaternions: (N, 4) unit, (w, x, y, z).
        time_s: s.
        max_gap_s: longest distance between two samples that is bridged, s.

    Returns:
        (4,) unit quaternion, or None outside of the samples and in longer gaps.
    """
    place = bracket(times_s, time_s, max_gap_s)
    if place is None:
        return None
    index, fraction = place
    return slerp(quaternions[index], quaternions[min(index + 1, len(quaternions) - 1)], fraction)


def are_rotations(matrices: ArrayLike, tolerance: float = 1e-3) -> NDArray[np.bool_]:
    """Which of (..., 3, 3) are rotations: lengths and angles kept to a tolerance, and no mirror.

    Example:
        >>> are_rotations([np.eye(3), -np.eye(3), np.full((3, 3), np.inf)]).tolist()
        [True, False, False]
    """
    m = np.asarray(matrices, np.float64)
    possible = np.asarray((np.abs(m) <= 2).all(axis=(-2, -1)))  # NaN is not
    tame = np.where(possible[..., None, None], m, 0.0)
    error = np.abs(tame @ np.swapaxes(tame, -2, -1) - np.eye(3)).max(axis=(-2, -1))
    return np.asarray(possible & (error <= tolerance) & (np.linalg.det(tame) > 0))


def unit(vector: ArrayLike) -> NDArray[np.float64]:
    """The vector at length one.

    Raises:
        ValueError: the vector is zero or not finite.
    """
    return _of_length_one(vector, "has no direction:")


def _of_length_one(values: ArrayLike, problem: str) -> NDArray[np.float64]:
    v = np.asarray(values, dtype=np.float64)
    norm = float(np.linalg.norm(v))
    if not (math.isfinite(norm) and norm > 1e-9):
        raise ValueError(f"{problem} {v.tolist()}")
    return v / norm


def up_in_camera(attitude_q: ArrayLike, mount_rpy_rad: Sequence[float]) -> NDArray[np.float64]:
    """The world's up direction in the optical frame, (3,) unit.

    Args:
        attitude_q: (w, x, y, z) body FRD to world NED.
        mount_rpy_rad: roll, pitch, yaw of the camera in the body; zero: the optical axis is the body's
            forward axis; negative pitch: it looks down.

    Example:
        >>> up_in_camera([1.0, 0.0, 0.0, 0.0], (0.0, 0.0, 0.0)).tolist()  # level: up is against v
        [0.0, -1.0, 0.0]
    """
    world_from_camera_frd = rotation_from_quaternion(attitude_q) @ rotation_from_rpy(*mount_rpy_rad)
    return unit(OPTICAL_FROM_FRD @ world_from_camera_frd.T @ UP_NED)
