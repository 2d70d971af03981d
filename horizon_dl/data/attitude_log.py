"""Attitudes over time, from a log: what a film or a folder of images lacks."""

from dataclasses import dataclass, replace
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.tables.parsing import MOST_HEIGHT_M, by_time
from horizon_dl.geometry.attitude import (
    MAX_GAP_S,
    MountRpy,
    bracket,
    interpolate,
    quaternion_from_rpy,
    up_in_camera,
    yaw_of,
)

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class AttitudeLog:
    """Attitudes of the body (FRD in NED), sorted by time.

    The camera's own attitude is given as that of a body whose forward axis is the optical one.

    Attributes:
        times_s: (N,) s, on the log's clock.
        quaternions: (N, 4) unit, (w, x, y, z).
        heights_m: (N,) metres of the camera over the floor, NaN where not known; None: nowhere.
        has_yaw: the heading is known; else yaw is zero and means nothing.
        shutter: the attitudes at which pictures were taken, one each, where the log tells.
        unix_start_s: time of the first attitude since 1970, s, where the log tells.
        notes: what its user should know, a sentence each.
        of_imu: estimated from samples of an IMU, in axes that its user names.
    """

    times_s: Floats
    quaternions: Floats
    heights_m: Floats | None = None
    has_yaw: bool = True
    shutter: Optional["AttitudeLog"] = None
    unix_start_s: float | None = None
    notes: tuple[str, ...] = ()
    of_imu: bool = False

    def header(self, name: str, time_s: float, mount_rpy_rad: MountRpy) -> FrameHeader:
        """What the log knows of a frame; gaps of over 0.2 s are not bridged.

        Args:
            name: of the frame.
            time_s: of the frame, on the log's clock.
            mount_rpy_rad: of the camera in the body.
        """
        attitude = interpolate(self.times_s, self.quaternions, time_s, MAX_GAP_S)
        if attitude is None:
            return FrameHeader(name, time_s)
        up, yaw = up_in_camera(attitude, mount_rpy_rad), yaw_of(attitude) if self.has_yaw else None
        as_read = tuple(attitude.tolist())
        return FrameHeader(name, time_s, up, yaw, self._height_at(time_s), as_read=as_read)

    def on_clock(self, offset_s: float, drift_ppm: float = 0.0) -> "AttitudeLog":
        """The log on the frames' clock.

        Args:
            offset_s: the frames' clock less the log's, at the log's start.
            drift_ppm: by how much the frames' clock is faster, millionths.

        Example:
            >>> log = AttitudeLog(np.array([5.0, 1005.0]), np.array([[1.0, 0, 0, 0]] * 2))
            >>> log.on_clock(-5.0, 1000.0).times_s.tolist()
            [0.0, 1001.0]
        """
        start = self.times_s[0]
        times = start + offset_s + (self.times_s - start) * (1.0 + drift_ppm * 1e-6)
        shutter = self.shutter
        if shutter is not None:
            moved = start + offset_s + (shutter.times_s - start) * (1.0 + drift_ppm * 1e-6)
            shutter = replace(shutter, times_s=moved)
        return replace(self, times_s=times, shutter=shutter)

    def _height_at(self, time_s: float) -> float | None:
        place = bracket(self.times_s, time_s, MAX_GAP_S)
        if self.heights_m is None or place is None:
            return None
        height_m = float(np.interp(time_s, self.times_s, self.heights_m))
        return height_m if 0 < height_m < MOST_HEIGHT_M else None


@dataclass(frozen=True)
class ConstantAttitude:
    """An attitude that stays: a tripod, a cart, a car on a level road."""

    roll_rad: float
    pitch_rad: float

    def header(self, name: str, time_s: float, mount_rpy_rad: MountRpy) -> FrameHeader:
        """As of `AttitudeLog.header`, at any time."""
        attitude = quaternion_from_rpy(self.roll_rad, self.pitch_rad, 0.0)
        return FrameHeader(name, time_s, up_in_camera(attitude, mount_rpy_rad), 0.0)


def log_of_angles(
    times_s: Floats, angles_rad: Floats, heights_m: Floats | None = None, has_yaw: bool = True
) -> AttitudeLog:
    """A log of roll, pitch and yaw; rows without a time, roll or pitch are left out. None may be left.

    Args:
        times_s: (N,) s, in any order.
        angles_rad: (N, 3) roll, pitch, yaw of the body, rad.
        heights_m: (N,) m, or None.
        has_yaw: see `AttitudeLog`.
    """
    good = np.isfinite(times_s) & np.isfinite(angles_rad[:, :2]).all(axis=1)
    heights = np.full(len(times_s), np.nan) if heights_m is None else heights_m
    kept = np.column_stack([np.nan_to_num(angles_rad), np.arange(len(times_s))])[good]
    times, rows = by_time(times_s[good], kept)
    quaternions = np.array([quaternion_from_rpy(*row) for row in rows[:, :3].tolist()]).reshape(-1, 4)
    known = heights[rows[:, 3].astype(np.int64)]
    return AttitudeLog(times, quaternions, known if np.isfinite(known).any() else None, has_yaw)


def angles_of_ups(ups: Floats) -> Floats:
    """Roll, pitch and a yaw of zero (N, 3), rad, of the world's up (N, 3) in the body (FRD).

    Example:
        >>> np.rad2deg(angles_of_ups(np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]))).round().tolist()
        [[0.0, 0.0, 0.0], [0.0, 90.0, 0.0]]
    """
    length = np.linalg.norm(ups, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        pitch = np.arcsin(np.clip(ups[:, 0] / length, -1.0, 1.0))
    roll = np.where(np.hypot(ups[:, 1], ups[:, 2]) > 1e-9, np.arctan2(-ups[:, 1], -ups[:, 2]), 0.0)
    return np.column_stack([roll, pitch, np.zeros(len(ups))])
