"""An attitude log that is a table: times, attitudes and heights, row by row."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.tables.attitude_columns import read_attitudes, read_times, require_attitude
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.table import Table
from horizon_dl.data.tables.units import LOG_STEPS
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

NEEDED = "needed are time_s, roll_rad, pitch_rad, or a gyroscope's and an accelerometer's x, y, z"

MOST_RESTARTS = 3
"""Falls of a clock; with more of them rows are merely out of order."""
LEAST_FALL_S = 1.0


@dataclass(frozen=True)
class AttitudeRows:
    """Attitudes of the body (FRD in NED), sorted by time; at least one.

    Attributes:
        times_s: (N,) s, on the table's clock.
        quaternions: (N, 4) unit, (w, x, y, z).
        yaws_rad: (N,), NaN where not known.
        heights_m: (N,), NaN where not known.
        notes: what its user should know, a sentence each.
    """

    times_s: Floats
    quaternions: Floats
    yaws_rad: Floats
    heights_m: Floats
    notes: tuple[str, ...] = ()


def read_attitude_table(table: Table, given: Given = NOTHING_GIVEN) -> AttitudeRows:
    """The rows of a table that have a time and an attitude.

    Columns are found by their names (`columns.KEYS`), units in the names or by the numbers.

    Raises:
        InputError: missing, a column is missing, a unit is not certain, or no row has an attitude.
    """
    columns = find_columns(table)
    require_attitude(table, columns, NEEDED)
    times_s, notes = read_times(table, columns, given, LOG_STEPS)
    rows = read_attitudes(table, columns, given)
    good = np.isfinite(times_s) & np.isfinite(rows.quaternions).all(axis=-1)
    if not good.any():
        raise InputError(table.path, "holds no attitude", "check that its values are numbers")
    notes = (*notes, *restarts(times_s[good]), *_stairs(times_s[good]))
    order = np.flatnonzero(good)[np.argsort(times_s[good], kind="stable")]
    return AttitudeRows(
        times_s[order],
        rows.quaternions[order],
        rows.yaws_rad[order],
        rows.heights_m[order],
        (*notes, *rows.notes),
    )


def mostly_stands(times_s: Floats) -> bool:
    """Whether most rows (N,) have the time of the row before: a clock of whole seconds, or a wrong column."""
    return len(times_s) > 1 and float(np.mean(np.diff(times_s) == 0.0)) > 0.5


def _stairs(times_s: Floats) -> tuple[Doubt, ...]:
    if not mostly_stands(times_s):
        return ()
    says = "most rows have the time of the row before, as of a clock that tells whole seconds"
    return (Doubt(f"{says}: the attitude between is off; give a finer clock as time_s"),)


def restarts(times_s: Floats) -> tuple[Doubt, ...]:
    """What is said of a clock that falls back once or a few times: a restart, or a counter that ran over.

    Args:
        times_s: (N,) s, as they stand in the table.
    """
    falls = np.flatnonzero(np.diff(times_s) < -LEAST_FALL_S)
    if not 0 < len(falls) <= MOST_RESTARTS:
        return ()
    back_s = float(times_s[falls[0]] - times_s[falls[0] + 1])
    says = f"the log's clock falls back by {back_s:.3f} s: rows are sorted by time, which is wrong"
    return (Doubt(f"{says} where it started anew or ran over; cut the table there, or correct its times"),)
