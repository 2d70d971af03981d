"""Units of a gyroscope and an accelerometer: those that are named, or that the two and gravity tell.

Carried by the gyroscope, the accelerometer's samples of some seconds have gravity as their mean. They cancel
where the rates are far too large, and agree less where they are too small and the IMU turns much.
"""

import numpy as np

from horizon_dl.data.attitude_log import Floats
from horizon_dl.data.imu import GRAVITY_M_S2
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.data.tables.table import Table
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.inertial import at_times, turned

FEWEST_SAMPLES = 10
METRES, GS, LEAST_COUNTS = (5.0, 20.0), (0.5, 2.0), 100.0
"""Medians of a force that are m/s^2, multiples of gravity, and numbers of a sensor's own unit."""

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


def agreement(gyro: tuple[Floats, Floats], accelerometer: tuple[Floats, Floats]) -> float:
    """How well a gyroscope carries an accelerometer's samples together: 1 where their means are gravity.

    Args:
        gyro: times (N,) s, sorted, and rates (N, 3) rad/s.
        accelerometer: times (M,) s, sorted, and forces (M, 3) m/s^2.
    """
    times_s, rates = gyro
    # A bias would make all rates disagree. What is lost with it is a steady turn, which is about up.
    rates = rates - rates.mean(axis=0)
    forces = at_times(times_s, accelerometer)
    lengths = []
    for start_s in np.linspace(times_s[0], max(times_s[0], times_s[-1] - PIECE_S), PIECES):
        piece = (times_s >= start_s) & (times_s <= start_s + PIECE_S)
        if piece.sum() > 1:
            carried = np.einsum("nij,nj->ni", turned(times_s[piece], rates[piece]), forces[piece])
            lengths.append(float(np.linalg.norm(carried.mean(axis=0))))
    return float(np.mean(lengths)) / GRAVITY_M_S2 if lengths else 1.0


def rad_s(
    table: Table, read: tuple[Floats, Floats], accelerometer: tuple[Floats, Floats], unit: str | None
) -> tuple[tuple[Floats, Floats], tuple[str, ...]]:
    """The gyroscope's times and rates, rad/s, and a note where its unit was told by the accelerometer.

    Args:
        table: for errors.
        read: times (N,) s, sorted, and rates (N, 3) as they are written.
        accelerometer: times (M,) s, sorted, and forces (M, 3) m/s^2.
        unit: `rad` or `deg`, where it is stated.

    Raises:
        InputError: the two do not agree, or no unit is stated and both would do.
    """
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


def m_s2(table: Table, forces: Floats, in_metres: bool) -> Floats:
    """Forces in m/s^2: a unit without a name is told by gravity, most of what an accelerometer feels.

    Args:
        table: for errors.
        forces: (N, 3) as they are written.
        in_metres: their names say m/s^2.

    Raises:
        InputError: they are in no unit of which gravity would be a part.
    """
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
