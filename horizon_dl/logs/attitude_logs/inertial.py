"""An attitude log from gyroscope and accelerometer of a finished recording.

The gyroscope carries all accelerometer samples into one frame, that of the start. There their mean over a
window around each moment is up: what the vehicle speeds up in it is slowed down again. A filter that only
knows the past takes a start under way for a tilt; this one has the future, too.
"""

import math

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, Floats, angles_of_ups, log_of_angles
from horizon_dl.data.imu import LONGEST_STEP_S, gyro_bias, still_bias

WINDOW_S = 10.0
"""On each side. Shorter ones feel manoeuvres, longer ones the gyroscope's drift."""

LONG_S = 60.0
"""Shorter recordings do not tell a gyroscope's bias from a manoeuvre."""


def log_of_inertial(
    gyro: tuple[Floats, Floats],
    accelerometer: tuple[Floats, Floats],
    frd_from_imu: Floats,
    *,
    gimbal: bool = False,
) -> AttitudeLog:
    """Attitudes at the gyroscope's times; the heading starts at 0.

    Args:
        gyro: times (N,) s, sorted, and rates (N, 3) rad/s.
        accelerometer: times (M,) s, sorted, and specific forces (M, 3) m/s^2, up at rest.
        frd_from_imu: (3, 3) from the IMU's axes to the body's (forward, right, down).
        gimbal: the IMU hangs in one: in the mean it neither rolls nor pitches.
    """
    times_s, rates = gyro
    forces = at_times(times_s, accelerometer)
    rates, forces = rates @ frd_from_imu.T, forces @ frd_from_imu.T
    rates = rates - _bias(times_s, rates, forces, gimbal)
    angles = angles_of_ups(_ups(times_s, rates, forces))
    roll, pitch = angles[:, 0], angles[:, 1]
    turning = (rates[:, 1] * np.sin(roll) + rates[:, 2] * np.cos(roll)) / np.maximum(np.cos(pitch), 0.1)
    angles[1:, 2] = np.cumsum((turning[1:] + turning[:-1]) / 2 * np.diff(times_s))
    return log_of_angles(times_s, angles)


def at_times(times_s: Floats, accelerometer: tuple[Floats, Floats]) -> Floats:
    """Forces (N, 3) at the times (N,) of a gyroscope, of an accelerometer's times (M,) and forces (M, 3)."""
    return np.stack([np.interp(times_s, accelerometer[0], axis) for axis in accelerometer[1].T], axis=-1)


def ups_of_inertial(times_s: Floats, rates: Floats, forces: Floats) -> Floats:
    """(N, 3) up, not of unit length, in the IMU's own axes, whatever they are; arguments as above, (N, 3)."""
    return _ups(times_s, rates - _bias(times_s, rates, forces, False), forces)


def _ups(times_s: Floats, rates: Floats, forces: Floats) -> Floats:
    """Each side of a longer gap by itself: how it was turned meanwhile nobody knows."""
    ends = np.flatnonzero(np.diff(times_s) > LONGEST_STEP_S) + 1
    parts = (np.split(values, ends) for values in (times_s, rates, forces))
    return np.concatenate([_ups_of_part(*part) for part in zip(*parts, strict=True)])


def _ups_of_part(times_s: Floats, rates: Floats, forces: Floats) -> Floats:
    start_from_body = turned(times_s, rates)
    ups = around(times_s, np.einsum("nij,nj->ni", start_from_body, forces))
    return np.asarray(np.einsum("nji,nj->ni", start_from_body, ups))


def _bias(times_s: Floats, rates: Floats, forces: Floats, gimbal: bool) -> Floats:
    """The gyroscope's bias (3,), rad/s."""
    if gimbal:
        return np.array([*rates[:, :2].mean(axis=0), 0.0])
    if times_s[-1] - times_s[0] > LONG_S:
        return np.array(gyro_bias(times_s, rates, forces))
    return np.array(still_bias(times_s, rates, forces) or (0.0, 0.0, 0.0))


def turned(times_s: Floats, rates: Floats) -> Floats:
    """Rotations (N, 3, 3) from the body at each time to the body at the first one, rates (N, 3) rad/s."""
    quaternion = (1.0, 0.0, 0.0, 0.0)
    quaternions = [quaternion]
    middle = (rates[1:] + rates[:-1]) / 2 * np.diff(times_s)[:, None]
    for x, y, z in middle.tolist():
        angle = math.sqrt(x * x + y * y + z * z)
        part = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
        quaternion = _product(quaternion, (math.cos(angle / 2), part * x, part * y, part * z))
        quaternions.append(quaternion)
    w, x, y, z = np.array(quaternions).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def around(times_s: Floats, values: Floats, window_s: float = WINDOW_S) -> Floats:
    """Means (N, k) of the values up to `window_s` before and after each time; shorter at the ends."""
    sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
    first = np.searchsorted(times_s, times_s - window_s, side="left")
    last = np.searchsorted(times_s, times_s + window_s, side="right")
    return np.asarray((sums[last] - sums[first]) / (last - first)[:, None])


Quaternion = tuple[float, float, float, float]


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )
