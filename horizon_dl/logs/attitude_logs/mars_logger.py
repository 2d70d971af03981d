"""MARS logger's `gyro_accel.csv` (Android): gyroscope and accelerometer in the phone's axes."""

from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time, column, read_table
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.inertial import log_of_inertial
from horizon_dl.logs.attitude_logs.phone_axes import frd_from_phone

NAME = "mars"
NEEDS = "MARS logger's gyro_accel.csv"
TIME = "Timestamp[nanosec]"
RATES = ("gx[rad/s]", "gy[rad/s]", "gz[rad/s]")
FORCES = ("ax[m/s^2]", "ay[m/s^2]", "az[m/s^2]")


def recognises(path: Path, head: bytes) -> bool:
    """Whether the header is this app's."""
    line = head.split(b"\n", 1)[0].decode("utf-8", "replace")
    return TIME in line and RATES[0] in line


def read(path: Path) -> AttitudeLog:
    """The attitude of the rear camera, seconds of the phone's own clock.

    Raises:
        InputError: columns are missing or hold no numbers, or there are too few rows.
    """
    rows = read_table(path, (TIME, *RATES, *FORCES))
    values = np.stack([column(path, rows, name) for name in (*RATES, *FORCES)], axis=-1)
    times_s, values = by_time(column(path, rows, TIME) * 1e-9, values, MOST_INERTIAL)
    if len(times_s) < 10:
        raise InputError(path, "holds less than ten samples", "record again")
    rates, forces = values[:, :3], values[:, 3:]
    return log_of_inertial((times_s, rates), (times_s, forces), frd_from_phone(forces.mean(axis=0)))
