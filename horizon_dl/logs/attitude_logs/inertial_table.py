"""A table of a gyroscope's and an accelerometer's samples: any IMU's own log."""

from dataclasses import replace

import numpy as np

from horizon_dl.calibration.mount import AxesNotStatedError, rotation_of_axes
from horizon_dl.data.attitude_log import AttitudeLog, Floats
from horizon_dl.data.given import Given
from horizon_dl.data.imu import GRAVITY_M_S2
from horizon_dl.data.tables.attitude_columns import read_times
from horizon_dl.data.tables.columns import best_columns
from horizon_dl.data.tables.inertial_columns import InertialColumns
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.data.tables.table import Table
from horizon_dl.data.tables.units import LOG_STEPS, DoubtError, rate_unit
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.inertial import log_of_inertial

FEWEST_SAMPLES = 10
METRES, GS, LEAST_COUNTS = (5.0, 20.0), (0.5, 2.0), 100.0
"""Medians of a force that are m/s^2, multiples of gravity, and numbers of a sensor's own unit."""


def read(table: Table, columns: InertialColumns, given: Given) -> AttitudeLog:
    """The attitude at the gyroscope's times; the heading starts at 0.

    Raises:
        InputError: a column is missing, a unit is not certain, the accelerometer feels no gravity, there are
            too few samples; AxesNotStatedError: nothing says where the IMU's axes point.
    """
    if given.imu_axes is None:
        raise AxesNotStatedError(
            table.path,
            "holds an IMU's own samples and does not state where its axes point",
            "give --imu-axes flu (x forward, y left, z up), frd or another; check-data finds it",
        )
    times_s, notes = read_times(table, best_columns(table.names), given, LOG_STEPS)
    samples = np.column_stack([table.numbers(name) for name in (*columns.rates, *columns.forces)])
    times_s, samples = by_time(times_s, samples)
    if len(times_s) < FEWEST_SAMPLES:
        raise InputError(table.path, f"holds under {FEWEST_SAMPLES} samples", "record again")
    rates, forces = _rad_s(table, samples[:, :3], columns, given), _m_s2(table, samples[:, 3:])
    times_s, samples = by_time(times_s, np.hstack([rates, forces]), MOST_INERTIAL)
    rates, forces = samples[:, :3], samples[:, 3:]
    log = log_of_inertial((times_s, rates), (times_s, forces), rotation_of_axes(given.imu_axes))
    note = "the attitude is estimated from gyroscope and accelerometer"
    return replace(log, of_imu=True, notes=(note, *notes))


def _rad_s(table: Table, rates: Floats, columns: InertialColumns, given: Given) -> Floats:
    try:
        unit = given.angle_unit or rate_unit(rates, columns.rate_unit)
    except DoubtError as doubt:
        raise InputError(table.path, f"{table.found}; {doubt.looks}", doubt.hint) from None
    return np.deg2rad(rates) if unit == "deg" else rates


def _m_s2(table: Table, forces: Floats) -> Floats:
    """Forces in m/s^2: their unit is told by gravity, which is most of what an accelerometer feels."""
    felt = float(np.median(np.linalg.norm(forces, axis=1)))
    if METRES[0] < felt < METRES[1]:
        return forces
    if GS[0] < felt < GS[1]:
        return forces * GRAVITY_M_S2
    if felt > LEAST_COUNTS:
        return forces * (GRAVITY_M_S2 / felt)
    raise InputError(
        table.path,
        f"its accelerometer feels {felt:.2g} at the median: neither 9.8 m/s^2 nor 1 g",
        "give the acceleration with gravity in it",
    )
