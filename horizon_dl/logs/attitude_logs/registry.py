"""Reads an attitude log of any known kind: each kind is asked whether the file is one of its own."""

import math
from pathlib import Path
from typing import Protocol

from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude, Floats
from horizon_dl.data.given import CONSTANT, MAVLINK, NOTHING_GIVEN, Given
from horizon_dl.data.regular_file import check_regular, check_there
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs import (
    csv_table,
    dataflash,
    dji_srt,
    gopro_track,
    mars_logger,
    px4_ulog,
    sensor_logger,
)

HEAD_BYTES = 4096
BINARY = {".ulg": "a PX4 log", ".bin": "an ArduPilot log"}


class LogKind(Protocol):
    """What the module of a kind of log offers."""

    NAME: str
    NEEDS: str

    def recognises(self, path: Path, head: bytes) -> bool:
        """Whether the file, which begins so, or folder looks like this kind."""

    def read(self, path: Path) -> AttitudeLog:
        """The log; at least one attitude."""


KINDS: tuple[LogKind, ...] = (
    px4_ulog,
    dataflash,
    gopro_track,
    dji_srt,
    mars_logger,
    sensor_logger,
)


def read_attitude(
    given: str, units: Given = NOTHING_GIVEN, frd_from_imu: Floats | None = None
) -> AttitudeLog | ConstantAttitude:
    """What `--attitude` names: `constant:ROLL,PITCH` in degrees, or the file of a log.

    Args:
        given: the option's value.
        units: what was given of a table's units, and of an IMU's axes.
        frd_from_imu: rotation (3, 3) from an IMU's axes to the body's, in place of those that are given.

    Raises:
        InputError: the angles are no angles, or the file cannot be read.

    Example:
        >>> round(read_attitude("constant:0,-90").pitch_rad, 3)
        -1.571
    """
    if given.startswith(MAVLINK):
        raise InputError(given, "is the attitude of a camera alone", "give a recording's own log")
    if given.startswith(CONSTANT):
        return constant_attitude(given)
    return read_attitude_log(Path(given), units, frd_from_imu)


def read_attitude_log(
    path: Path, units: Given = NOTHING_GIVEN, frd_from_imu: Floats | None = None
) -> AttitudeLog:
    """The attitude log in a file, or in an app's folder, of any kind.

    Raises:
        InputError: it is not there or cannot be read; the error says what is needed.
    """
    check_there(path)
    head = b"" if path.is_dir() else _head(path)
    for kind in KINDS:
        if kind.recognises(path, head):
            return kind.read(path)
    if path.suffix.lower() in BINARY:
        raise InputError(path, f"does not begin as {BINARY[path.suffix.lower()]} does", "copy it again")
    if path.is_dir():
        needs = "; ".join([kind.NEEDS for kind in KINDS] + [csv_table.NEEDS])
        raise InputError(path, "is a folder, and no app's export", f"needed is one of: {needs}")
    return csv_table.read(path, units, frd_from_imu)


def _head(path: Path) -> bytes:
    check_regular(path)
    try:
        with path.open("rb") as file:
            return file.read(HEAD_BYTES)
    except OSError as error:
        raise InputError(path, f"cannot be read ({type(error).__name__})", "check the file") from None


def constant_attitude(given: str) -> ConstantAttitude:
    """Of `constant:ROLL,PITCH` in degrees.

    Raises:
        InputError: the angles are no angles.
    """
    angles = given.removeprefix(CONSTANT)
    try:
        roll, pitch = (float(angle) for angle in angles.split(","))
    except ValueError:
        roll = pitch = math.nan
    if not (abs(roll) <= 180 and abs(pitch) <= 90):
        problem = "are no roll and pitch in degrees"
        raise InputError(f"--attitude constant:{angles}", problem, "give for example constant:0,-10")
    return ConstantAttitude(math.radians(roll), math.radians(pitch))
