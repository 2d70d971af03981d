"""A table of a gyroscope's and an accelerometer's samples: any IMU's own log."""

from dataclasses import replace

import numpy as np

from horizon_dl.calibration.mount import AxesNotStatedError, rotation_of_axes
from horizon_dl.data.attitude_log import AttitudeLog, Floats
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import Given
from horizon_dl.data.imu import GRAVITY_M_S2, still_bias
from horizon_dl.data.tables.attitude_columns import read_times
from horizon_dl.data.tables.attitude_table import mostly_stands, restarts
from horizon_dl.data.tables.columns import best_columns
from horizon_dl.data.tables.inertial_columns import InertialColumns
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.data.tables.table import Table
from horizon_dl.data.tables.units import IMU_STEPS
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.inertial import LONG_S, log_of_inertial, turned

FEWEST_SAMPLES = 10
METRES, GS, LEAST_COUNTS = (5.0, 20.0), (0.5, 2.0), 100.0
"""Medians of a force that are m/s^2, multiples of gravity, and numbers of a sensor's own unit."""

FINEST_S = 1 / 200
PIECE_S, PIECES = 10.0, 12
LEAST_AGREEMENT = 0.5
"""Of forces that the gyroscope carries together; with rates far too large they cancel to under a fifth."""
CLEARER = 4.0
TELLS = 0.05
"""A unit without a name is told where the other one's loss is so many times as large, and at least this.

These were set by made flights, and looked at on one EuRoC flight and two GoPro films: with the right unit
the agreement is .98 to 1.00 there, with degrees taken for radians .13 to .31, or all the same where it hardly
turns; half and twice the rates are told apart by none of them, so that those are asked about or let pass.
"""


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
    forces = by_time(read_forces[0], _m_s2(table, read_forces[1], columns.in_metres), MOST_INERTIAL)
    unit = given.angle_unit or columns.rate_unit
    gyro, told = _rad_s(table, read_rates, forces, unit)
    log = log_of_inertial(gyro, forces, frd_from_imu)
    note = "the attitude is estimated from gyroscope and accelerometer: a few degrees off while it speeds up"
    return replace(log, of_imu=True, notes=(note, *notes, *told, *_bias_doubt(gyro, forces)))


def _bias_doubt(gyro: tuple[Floats, Floats], forces: tuple[Floats, Floats]) -> tuple[Doubt, ...]:
    """What is said of a recording that does not tell the gyroscope's bias."""
    times_s, rates = gyro
    felt = np.stack([np.interp(times_s, forces[0], axis) for axis in forces[1].T], axis=-1)
    if times_s[-1] - times_s[0] > LONG_S or still_bias(times_s, rates, felt) is not None:
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


def agreement(gyro: tuple[Floats, Floats], accelerometer: tuple[Floats, Floats]) -> float:
    """How well a gyroscope carries an accelerometer's samples together: 1 where their means are gravity.

    Args:
        gyro: times (N,) s, sorted, and rates (N, 3) rad/s.
        accelerometer: times (M,) s, sorted, and forces (M, 3) m/s^2.
    """
    times_s, rates = gyro
    # A bias would make all rates disagree. What is lost with it is a steady turn, which is about up.
    rates = rates - rates.mean(axis=0)
    forces = np.stack([np.interp(times_s, accelerometer[0], axis) for axis in accelerometer[1].T], axis=-1)
    lengths = []
    for start_s in np.linspace(times_s[0], max(times_s[0], times_s[-1] - PIECE_S), PIECES):
        piece = (times_s >= start_s) & (times_s <= start_s + PIECE_S)
        if piece.sum() > 1:
            carried = np.einsum("nij,nj->ni", turned(times_s[piece], rates[piece]), forces[piece])
            lengths.append(float(np.linalg.norm(carried.mean(axis=0))))
    return float(np.mean(lengths)) / GRAVITY_M_S2 if lengths else 1.0


def _rad_s(
    table: Table, read: tuple[Floats, Floats], accelerometer: tuple[Floats, Floats], unit: str | None
) -> tuple[tuple[Floats, Floats], tuple[str, ...]]:
    """The gyroscope's times and rates, rad/s, and a note where its unit was told by the accelerometer."""
    by_unit = {
        name: by_time(read[0], read[1] * scale, MOST_INERTIAL)
        for name, scale in (("rad", 1.0), ("deg", np.pi / 180))
    }
    possible = {name: gyro for name, gyro in by_unit.items() if len(gyro[0]) >= FEWEST_SAMPLES}
    agreements = {name: agreement(gyro, accelerometer) for name, gyro in possible.items()}
    fitting = {name: value for name, value in agreements.items() if value >= LEAST_AGREEMENT}
    if not fitting or (unit and unit not in fitting):
        problem = "its gyroscope and accelerometer do not agree: the rates are in another unit or other axes"
        raise InputError(table.path, problem, "give rates in rad/s or degrees/s, of the accelerometer's axes")
    best = unit or max(fitting, key=lambda name: fitting[name])
    for factor in (0.5, 2.0):
        times_s, rates = possible[best]
        if _clearer(agreement((times_s, factor * rates), accelerometer), fitting[best]):
            problem = f"its gyroscope agrees with its accelerometer if its rates are taken times {factor:g}"
            raise InputError(table.path, problem, "correct the rates, or the clock's unit")
    if unit:
        return possible[unit], ()
    if not all(_clearer(fitting[best], agreements.get(name, 0.0)) for name in by_unit if name != best):
        raise InputError(
            table.path, f"{table.found}; the rates have no unit", "--angle-unit rad or --angle-unit deg"
        )
    words = {"rad": "radians", "deg": "degrees"}[best]
    return possible[best], (f"the rates are read as {words} a second, with which the accelerometer agrees",)


def _clearer(agrees: float, other: float) -> bool:
    """Whether one reading of the rates agrees so much better than another that it is the right one."""
    return 1.0 - other > max(TELLS, CLEARER * (1.0 - agrees))


def _m_s2(table: Table, forces: Floats, in_metres: bool) -> Floats:
    """Forces in m/s^2: a unit without a name is told by gravity, most of what an accelerometer feels."""
    felt = float(np.median(np.linalg.norm(forces, axis=1)))
    if METRES[0] < felt < METRES[1]:
        return forces
    if GS[0] < felt < GS[1] and not in_metres:
        return forces * GRAVITY_M_S2
    if felt > LEAST_COUNTS and not in_metres:
        return forces * (GRAVITY_M_S2 / felt)
    raise InputError(
        table.path,
        f"its accelerometer feels {felt:.2g} at the median: neither 9.8 m/s^2 nor 1 g",
        "give the acceleration with gravity in it",
    )
