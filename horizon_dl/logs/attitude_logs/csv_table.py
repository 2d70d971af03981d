"""An attitude log as a table: time, roll, pitch and, where known, yaw and height; or an IMU's samples."""

from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.tables.attitude_table import has_attitude, read_attitude_table
from horizon_dl.data.tables.inertial_columns import inertial_columns
from horizon_dl.data.tables.table import read_table
from horizon_dl.logs.attitude_logs import inertial_table

NEEDS = "a table with the columns time_s, roll_rad, pitch_rad, yaw_rad, height_m, or those of an IMU"


def read(path: Path, given: Given = NOTHING_GIVEN) -> AttitudeLog:
    """Rows without an attitude are left out; yaw and height may be missing.

    Other names, separators and units are read where they are certain.

    Raises:
        InputError: missing, a column is missing, or no row has an attitude.
    """
    table = read_table(path)
    inertial = None if has_attitude(table) else inertial_columns(table.names)
    if inertial is not None:
        return inertial_table.read(table, inertial, given)
    rows = read_attitude_table(table, given)
    heights = rows.heights_m if np.isfinite(rows.heights_m).any() else None
    has_yaw = bool(np.isfinite(rows.yaws_rad).any())
    return AttitudeLog(rows.times_s, rows.quaternions, heights, has_yaw, notes=rows.notes)
