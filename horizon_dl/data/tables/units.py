"""Units of clocks and angles: the one named, unless the numbers rule it out; else the only one that fits."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.tables.columns import TIME_UNITS

Floats = NDArray[np.float64]

UNIT_NAMES = {"s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}
DAY_S = 86400.0
EPOCH_S = (1e9, 2.3e9)
"""Unix time from 2001 to 2042."""

STILL_DEG = 0.6
"""Rolls and pitches within this may as well be radians, of up to 34 degrees."""

SHORTEST_NAMED_S = 2e-5
"""Shorter steps, of over 50 kHz, make one doubt a named unit; so do longer ones than the clock's kind has."""


@dataclass(frozen=True)
class Steps:
    """Usual steps of a clock, seconds: what a sensor of some kind may have."""

    shortest_s: float
    longest_s: float
    useless_beyond: bool = False


CAMERA_STEPS = Steps(1 / 250, 10.0)
LOG_STEPS = Steps(1 / 2000, 2.0, useless_beyond=True)
"""An attitude log; slower ones are of no use, so numbers that would make it slower are in another unit."""

IMU_STEPS = Steps(1 / 20_000, 0.1, useless_beyond=True)
"""A gyroscope; from slower ones no attitude can be told."""


class DoubtError(ValueError):
    """More than one unit is possible: what it looks like, and a hint."""

    def __init__(self, looks: str, hint: str) -> None:
        super().__init__(looks, hint)
        self.looks, self.hint = looks, hint


def clock_unit(values: Floats, named: str | None, steps: Steps) -> str:
    """The unit of a clock: `s`, `ms`, `us` or `ns`.

    Args:
        values: (N,) as written; NaN where there is none.
        named: the unit in the column's name, or None.
        steps: what the clock's kind may have.

    Raises:
        DoubtError: the numbers rule the named unit out, or none is named, and they do not tell which it is.

    Example:
        >>> clock_unit(np.array([0, 33, 67, 100.0]), None, CAMERA_STEPS)
        'ms'
    """
    known = values[np.isfinite(values)]
    forward = np.diff(known)[np.diff(known) > 0]
    if not len(forward):
        return named or epoch_unit(known) or "s"
    step = float(np.median(forward))
    whole = bool((known == np.round(known)).all())
    if named and (SHORTEST_NAMED_S <= step * TIME_UNITS[named] <= steps.longest_s or not whole):
        return named
    fitting = [u for u, size in TIME_UNITS.items() if steps.shortest_s <= step * size <= steps.longest_s]
    epoch = [unit for unit in fitting if _is_epoch(known, unit)]
    fitting = epoch or fitting
    if not whole and "s" in fitting:
        return "s"
    if len(fitting) == 1 and (not named or epoch or steps.useless_beyond):
        return fitting[0]
    if not fitting and not named and steps.shortest_s <= step * DAY_S <= steps.longest_s:
        looks = f"time looks like days, as of a spreadsheet, by its steps of {step:g}"
        raise DoubtError(looks, "write seconds: days times 86400; or --time-unit s if that is right")
    if not fitting:
        return named or "s"
    looks = f"time looks like {' or '.join(UNIT_NAMES[unit] for unit in fitting)}, by its steps of {step:g}"
    others = f", or --time-unit {named} if that is right" if named else ""
    raise DoubtError(looks, f"--time-unit {' or '.join(fitting)}{others}")


def angle_unit(levels: Sequence[Floats], headings: Sequence[Floats], named: str | None) -> str:
    """The unit of angles, `rad` or `deg`: over a turn's 2 pi are degrees.

    Args:
        levels: rolls and pitches as written, which do not count turns.
        headings: yaws as written, which may count a few turns.
        named: the unit in the columns' names, or None.

    Raises:
        DoubtError: none is named, and all angles are small, or roll and pitch alone; or they are in neither.

    Example:
        >>> angle_unit([np.array([3.0, 12.0, 14.0])], [], None)
        'deg'
    """
    if any(often_over(values, 360.0) for values in levels):
        looks = (
            "roll and pitch are over a full turn in degrees, too: tenths, hundredths or thousandths of one"
        )
        raise DoubtError(looks, "divide them, and name the columns roll_deg and pitch_deg")
    if named == "deg":
        return "deg"
    if any(often_over(values, 2 * math.pi) for values in levels):
        return "deg"
    if named:
        return named
    hint = "--angle-unit rad or --angle-unit deg"
    if any(counts_degrees(values) for values in headings):
        if levels and not any(often_over(values, STILL_DEG) for values in levels):
            looks = "the heading is in degrees, and roll and pitch are so small that they may be radians"
            raise DoubtError(looks, hint)
        return "deg"
    raise DoubtError("the angles have no unit", hint)


def counts_degrees(headings: Floats) -> bool:
    """Whether headings (N,) are degrees: as radians they would count more turns than one flies."""
    return often_over(headings, 8 * math.pi)


def often_over(values: Floats, limit: float) -> bool:
    """Whether more numbers than a few glitches are over a limit."""
    known = np.abs(values[np.isfinite(values)])
    return bool((known > limit).sum() > 0.01 * len(known))


def epoch_unit(known: Floats) -> str | None:
    """The unit in which numbers (N,) are Unix time; None where they are in none."""
    return next((unit for unit in TIME_UNITS if len(known) and _is_epoch(known, unit)), None)


def _is_epoch(known: Floats, unit: str) -> bool:
    return bool(EPOCH_S[0] <= float(np.median(known)) * TIME_UNITS[unit] <= EPOCH_S[1])
