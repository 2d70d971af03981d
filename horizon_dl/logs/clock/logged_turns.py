"""How the camera turned by the log, summed from its start: between two times, a difference."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy

Floats = NDArray[np.float64]

STILL_YAW_RAD = 1e-3


def logged_turns(log: AttitudeLog, mount_rpy_rad: Sequence[float]) -> Floats:
    """(N, 3) turns about the optical axes since the log's start, summed, rad.

    Small turns add up; over the time between two pictures that is exact enough.
    """
    steps = _steps(log.quaternions)
    optical_from_body = OPTICAL_FROM_FRD @ rotation_from_rpy(*mount_rpy_rad).T
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps @ optical_from_body.T, axis=0)])


def knows_heading(log: AttitudeLog) -> bool:
    """Whether the log's heading is known and moves; one that never does is a column of zeros."""
    w, x, y, z = log.quaternions.T
    yaw = np.unwrap(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    return log.has_yaw and float(np.ptp(yaw)) > STILL_YAW_RAD


def _steps(quaternions: Floats) -> Floats:
    """Rotation vectors (N - 1, 3) from each attitude to the next, in the body's axes."""
    w0, v0 = quaternions[:-1, :1], -quaternions[:-1, 1:]
    w1, v1 = quaternions[1:, :1], quaternions[1:, 1:]
    real = w0 * w1 - (v0 * v1).sum(axis=1, keepdims=True)
    imaginary = w0 * v1 + w1 * v0 + np.cross(v0, v1)
    imaginary = np.where(real < 0, -imaginary, imaginary)
    length = np.linalg.norm(imaginary, axis=1, keepdims=True)
    angle = 2 * np.arctan2(length, np.abs(real))
    return np.asarray(imaginary * np.where(length > 1e-12, angle / np.maximum(length, 1e-12), 2.0))


def mean_up(log: AttitudeLog, mount_rpy_rad: Sequence[float]) -> Floats:
    """(3,) unit, the world's up in the optical frame, in the mean over the log."""
    w, x, y, z = log.quaternions.T
    up_body = -np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1).mean(
        axis=0
    )
    up = OPTICAL_FROM_FRD @ rotation_from_rpy(*mount_rpy_rad).T @ up_body
    return np.asarray(up / max(float(np.linalg.norm(up)), 1e-9))
