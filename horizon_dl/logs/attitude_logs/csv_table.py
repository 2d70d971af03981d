"""An attitude log as a table: time, roll, pitch and, where known, yaw and height."""

from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.tables.attitude_table import read_attitude_table

NEEDS = "a table with the columns time_s, roll_rad, pitch_rad, yaw_rad, height_m"


def read(path: Path, given: Given = NOTHING_GIVEN) -> AttitudeLog:
    """Rows without an attitude are left out; yaw and height may be missing.

    Other names, separators and units are read where they are certain.

    Raises:
        InputError: missing, a column is missing, or no row has an attitude.
    """
    rows = read_attitude_table(path, given)
    heights = rows.heights_m if np.isfinite(rows.heights_m).any() else None
    has_yaw = bool(np.isfinite(rows.yaws_rad).any())
    return AttitudeLog(rows.times_s, rows.quaternions, heights, has_yaw, notes=rows.notes)
