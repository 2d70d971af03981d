"""Attitudes over time, from a log: what a film or a folder of images lacks."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.readers.parsing import MAX_GAP_S, MOST_HEIGHT_M
from horizon_dl.data.source import MountRpy
from horizon_dl.data.tables.attitude_table import read_attitude_table
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import bracket, interpolate, quaternion_from_rpy, up_in_camera, yaw_of

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class AttitudeLog:
    """Attitudes of the body (FRD in NED), sorted by time.

    Attributes:
        times_s: (N,) s, on the log's clock.
        quaternions: (N, 4) unit, (w, x, y, z).
        heights_m: (N,) metres of the camera over the floor, NaN where not known; None: nowhere.
        notes: what its user should know, a sentence each.
    """

    times_s: Floats
    quaternions: Floats
    heights_m: Floats | None = None
    notes: tuple[str, ...] = ()

    def header(self, name: str, time_s: float, mount_rpy_rad: MountRpy, offset_s: float = 0.0) -> FrameHeader:
        """What the log knows of a frame; gaps of over 0.2 s are not bridged.

        Args:
            name: of the frame.
            time_s: of the frame, on its own clock.
            mount_rpy_rad: of the camera in the body.
            offset_s: the frames' clock less the log's.
        """
        attitude = interpolate(self.times_s, self.quaternions, time_s - offset_s, MAX_GAP_S)
        if attitude is None:
            return FrameHeader(name, time_s)
        return FrameHeader(
            name,
            time_s,
            up_in_camera(attitude, mount_rpy_rad),
            yaw_of(attitude),
            self._height_at(time_s - offset_s),
            as_read=tuple(attitude.tolist()),
        )

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

    def header(self, name: str, time_s: float, mount_rpy_rad: MountRpy, offset_s: float = 0.0) -> FrameHeader:
        """As of `AttitudeLog.header`, at any time."""
        attitude = quaternion_from_rpy(self.roll_rad, self.pitch_rad, 0.0)
        return FrameHeader(name, time_s, up_in_camera(attitude, mount_rpy_rad), 0.0)


def read_attitude(given: str, units: Given = NOTHING_GIVEN) -> AttitudeLog | ConstantAttitude:
    """What `--attitude` names: `constant:ROLL,PITCH` in degrees, or the file of a log.

    Raises:
        InputError: the angles are no angles, or the file cannot be read.

    Example:
        >>> round(read_attitude("constant:0,-90").pitch_rad, 3)
        -1.571
    """
    kind, _, rest = given.partition(":")
    return _constant(rest) if kind == "constant" else read_attitude_csv(Path(given), units)


def _constant(angles: str) -> ConstantAttitude:
    try:
        roll, pitch = (float(angle) for angle in angles.split(","))
    except ValueError:
        roll = pitch = math.nan
    if not (abs(roll) <= 180 and abs(pitch) <= 90):
        problem = "are no roll and pitch in degrees"
        raise InputError(f"--attitude constant:{angles}", problem, "give for example constant:0,-10")
    return ConstantAttitude(math.radians(roll), math.radians(pitch))


def read_attitude_csv(path: Path, given: Given = NOTHING_GIVEN) -> AttitudeLog:
    """The attitude log in a table with the columns time_s, roll_rad, pitch_rad, yaw_rad, height_m.

    Rows without an attitude are left out; yaw and height may be missing. Other names, separators and units
    are read where they are certain.

    Raises:
        InputError: missing, a column is missing, or no row has an attitude.
    """
    rows = read_attitude_table(path, given)
    heights = rows.heights_m if np.isfinite(rows.heights_m).any() else None
    return AttitudeLog(rows.times_s, rows.quaternions, heights, rows.notes)
