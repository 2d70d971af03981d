"""Sensor Logger's export (Android and iOS): a folder with Gravity.csv, or TotalAcceleration and Gyroscope."""

from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, Floats, angles_of_ups, log_of_angles
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time, column, read_table
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.inertial import log_of_inertial
from horizon_dl.logs.attitude_logs.phone_axes import frd_from_phone

NAME = "sensor_logger"
NEEDS = "Sensor Logger's export: its folder or Gravity.csv"
TABLES = ({"x", "y", "z"}, {"qw", "qx", "qy", "qz"})
"""Columns of gravity, forces and rates, and of Orientation.csv: its axes differ by system, it is not used."""
GRAVITY, ACCELERATION, GYROSCOPE = "Gravity.csv", "TotalAcceleration.csv", "Gyroscope.csv"


def recognises(path: Path, head: bytes) -> bool:
    """Whether it is the app's folder, or a table of its."""
    if path.is_dir():
        return (path / GRAVITY).is_file() or (path / ACCELERATION).is_file()
    columns = {name.strip() for name in head.split(b"\n", 1)[0].decode("utf-8", "replace").split(",")}
    return {"time", "seconds_elapsed"} <= columns and any(names <= columns for names in TABLES)


def read(path: Path) -> AttitudeLog:
    """The attitude of the rear camera; seconds since 1970, the phone's clock.

    Raises:
        InputError: neither gravity nor acceleration and rates, or a table cannot be read.
    """
    folder = path if path.is_dir() else path.parent
    sign, notes = _sign(folder)
    if (folder / GRAVITY).is_file():
        times_s, gravity = _table(folder / GRAVITY)
        ups = sign * gravity
        axes = frd_from_phone(ups.mean(axis=0))
        log = log_of_angles(times_s, angles_of_ups(ups @ axes.T), has_yaw=False)
    elif (folder / ACCELERATION).is_file() and (folder / GYROSCOPE).is_file():
        times_s, forces = _table(folder / ACCELERATION)
        axes = frd_from_phone(sign * forces.mean(axis=0))
        log = log_of_inertial(_table(folder / GYROSCOPE), (times_s, sign * forces), axes)
    else:
        raise InputError(
            path, f"has no {GRAVITY}", "switch the gravity sensor on in Sensor Logger and record again"
        )
    return AttitudeLog(log.times_s, log.quaternions, None, log.has_yaw, None, float(log.times_s[0]), notes)


def _sign(folder: Path) -> tuple[float, tuple[str, ...]]:
    """-1 where the system lets gravity point down (iOS, unless its units were made standard), else 1."""
    metadata = folder / "Metadata.csv"
    if not metadata.is_file():
        note = Doubt(
            "No Metadata.csv: taken as Android's axes. Of iOS they would give the pitch the wrong sign: "
            "check the horizon in the pictures."
        )
        return 1.0, (note,)
    row = read_table(metadata, ("platform",))[0]
    apple = row["platform"].lower().startswith(("ios", "iphone", "ipad"))
    standard = row.get("standardisation", "false").lower() == "true"
    return (-1.0 if apple and not standard else 1.0), ()


def _table(path: Path) -> tuple[Floats, Floats]:
    """Times (N,) s since 1970 and x, y, z (N, 3)."""
    rows = read_table(path, ("time", "x", "y", "z"))
    values = np.stack([column(path, rows, name) for name in ("x", "y", "z")], axis=-1)
    times_s, values = by_time(column(path, rows, "time") * 1e-9, values, MOST_INERTIAL)
    if len(times_s) < 2:
        raise InputError(path, "holds less than two samples", "record again")
    return times_s, values
