"""An attitude log as a table: time, roll, pitch and, where known, yaw and height; or an IMU's samples."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, Floats
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.tables.attitude_columns import has_attitude
from horizon_dl.data.tables.attitude_doubts import turns_nothing
from horizon_dl.data.tables.attitude_table import read_attitude_table
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.inertial_columns import inertial_columns
from horizon_dl.data.tables.table import read_table
from horizon_dl.logs.attitude_logs import gyroflow, inertial_table

NEEDS = "a table with the columns time_s, roll_rad, pitch_rad, yaw_rad, height_m, or those of an IMU"


def read(path: Path, given: Given = NOTHING_GIVEN, frd_from_imu: Floats | None = None) -> AttitudeLog:
    """Rows without an attitude are left out; yaw and height may be missing.

    Samples of an IMU give an estimate. Other names, separators and units are read where they are certain.

    Args:
        path: of the table.
        given: units, and the axes of an IMU.
        frd_from_imu: rotation (3, 3) from an IMU's axes to the body's, in place of those that are given.

    Raises:
        InputError: missing, a column is missing, or no row has an attitude.
    """
    if gyroflow.recognises(path):  # its head tells the units
        table, given = gyroflow.read_samples(path), replace(given, time_unit=None, angle_unit=None)
    else:
        table = read_table(path)
    columns, inertial = find_columns(table), inertial_columns(table.names)
    estimated = has_attitude(columns) and not turns_nothing(table, columns)
    if inertial is not None and not estimated:
        return inertial_table.read(table, inertial, given, frd_from_imu)
    rows = read_attitude_table(table, given)
    heights = rows.heights_m if np.isfinite(rows.heights_m).any() else None
    has_yaw = bool(np.isfinite(rows.yaws_rad).any())
    return AttitudeLog(rows.times_s, rows.quaternions, heights, has_yaw, notes=rows.notes)
