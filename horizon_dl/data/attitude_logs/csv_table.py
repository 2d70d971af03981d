"""An attitude log as a table: time, roll, pitch and, where known, yaw and height."""

from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, log_of_angles
from horizon_dl.data.readers.parsing import column, read_table
from horizon_dl.errors import InputError

NAME = "table"
NEEDS = "a CSV file with the columns time_s, roll_rad, pitch_rad, yaw_rad, height_m"
COLUMNS = ("time_s", "roll_rad", "pitch_rad", "yaw_rad")


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file is text; asked last."""
    return path.is_file()


def read(path: Path) -> AttitudeLog:
    """Rows without an attitude are left out; yaw and height may be missing.

    Raises:
        InputError: missing, a column is missing, or no row has an attitude.
    """
    rows = read_table(path, COLUMNS[:3])
    times_s, roll, pitch, yaw, height = (column(path, rows, name) for name in (*COLUMNS, "height_m"))
    log = log_of_angles(times_s, np.stack([roll, pitch, yaw], axis=-1), height, bool(np.isfinite(yaw).any()))
    if not len(log.times_s):
        raise InputError(path, "holds no attitude", "check that its values are numbers")
    return log
