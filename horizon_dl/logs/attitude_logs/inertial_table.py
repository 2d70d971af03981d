"""A table of a gyroscope's and an accelerometer's samples: any IMU's own log."""

from dataclasses import replace

import numpy as np

from horizon_dl.calibration.mount import AxesNotStatedError, rotation_of_axes
from horizon_dl.data.attitude_log import AttitudeLog, Floats
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import Given
from horizon_dl.data.imu import still_bias
from horizon_dl.data.tables.attitude_columns import read_times
from horizon_dl.data.tables.attitude_table import mostly_stands, restarts
from horizon_dl.data.tables.columns import best_columns
from horizon_dl.data.tables.inertial_columns import InertialColumns
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.data.tables.table import Table
from horizon_dl.data.tables.units import IMU_STEPS
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.inertial import LONG_S, at_times, log_of_inertial
from horizon_dl.logs.attitude_logs.inertial_units import FEWEST_SAMPLES, m_s2, rad_s

FINEST_S = 1 / 200
"""Samples that come faster are thinned to this."""


def read(
    table: Table, columns: InertialColumns, given: Given, frd_from_imu: Floats | None = None
) -> AttitudeLog:
    """The attitude at the gyroscope's times; the heading starts at 0.

    Args:
        table: with the columns.
        columns: their names.
        given: units, and the IMU's axes.
        frd_from_imu: rotation (3, 3) from the IMU's axes to the body's, in place of those that are given.

    Raises:
        InputError: a column is missing, a unit is not certain, the accelerometer feels no gravity, the two
            sensors do not agree, the clock starts anew, or there are too few samples; AxesNotStatedError:
            nothing says where the IMU's axes point.
    """
    frd_from_imu = _stated(table, given) if frd_from_imu is None else frd_from_imu
    times_s, notes = read_times(table, best_columns(table.names), given, IMU_STEPS)
    known_s = times_s[np.isfinite(times_s)]
    if restarts(known_s):
        raise InputError(table.path, "has a clock that starts anew", "cut the table there")
    if mostly_stands(known_s):
        problem = "its clock stands still in most rows, as of whole seconds"
        raise InputError(table.path, problem, "give a finer clock as time_s")
    read_rates, read_forces = (
        _thinned(*by_time(times_s, np.column_stack([table.numbers(name) for name in names])))
        for names in (columns.rates, columns.forces)
    )
    if min(len(read_rates[0]), len(read_forces[0])) < FEWEST_SAMPLES:
        raise InputError(table.path, f"holds under {FEWEST_SAMPLES} samples", "record again")
    forces = by_time(read_forces[0], m_s2(table, read_forces[1], columns.in_metres), MOST_INERTIAL)
    unit = given.angle_unit or columns.rate_unit
    gyro, told = rad_s(table, read_rates, forces, unit)
    log = log_of_inertial(gyro, forces, frd_from_imu)
    note = "the attitude is estimated from gyroscope and accelerometer: a few degrees off while it speeds up"
    return replace(log, of_imu=True, notes=(note, *notes, *told, *_bias_doubt(gyro, forces)))


def _bias_doubt(gyro: tuple[Floats, Floats], forces: tuple[Floats, Floats]) -> tuple[Doubt, ...]:
    """What is said of a recording that does not tell the gyroscope's bias."""
    times_s, rates = gyro
    still = still_bias(times_s, rates, at_times(times_s, forces))
    if still is not None or times_s[-1] - times_s[0] > LONG_S:
        return ()
    says = (
        "the IMU neither stands still at the start nor runs for a minute: its gyroscope's bias is not known"
    )
    return (Doubt(f"{says}, and with a cheap one up may be some degrees off"),)


def _thinned(times_s: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Samples (N,), (N, 3) of a few kHz as their means over a 200th of a second each: more tell no more."""
    if len(times_s) < 2 or float(np.median(np.diff(times_s))) > FINEST_S / 2:
        return times_s, values
    bins = np.floor((times_s - times_s[0]) / FINEST_S)
    starts = np.flatnonzero(np.diff(bins, prepend=-1.0))
    counts = np.diff(starts, append=len(times_s))
    return np.add.reduceat(times_s, starts) / counts, np.add.reduceat(values, starts) / counts[:, None]


def _stated(table: Table, given: Given) -> Floats:
    if given.imu_axes is None:
        raise AxesNotStatedError(
            table.path,
            "holds an IMU's own samples and does not state where its axes point",
            "give --imu-axes flu (x forward, y left, z up), frd or another; check-data finds it",
        )
    return rotation_of_axes(given.imu_axes)
