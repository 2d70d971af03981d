"""Time, attitude and height from the columns of a table."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.convention import Convention
from horizon_dl.data.given import Given
from horizon_dl.data.tables.attitude_doubts import attitude_doubts
from horizon_dl.data.tables.columns import (
    LENGTH_UNITS,
    TIME_UNITS,
    Column,
    is_of_message,
    parts_beside,
    require,
)
from horizon_dl.data.tables.find_columns import ANGLES, QUATERNION
from horizon_dl.data.tables.iso_time import seconds_of_dates
from horizon_dl.data.tables.parsing import usable_quaternions
from horizon_dl.data.tables.table import Table
from horizon_dl.data.tables.units import (
    UNIT_NAMES,
    DoubtError,
    Steps,
    angle_unit,
    clock_unit,
    counts_degrees,
    often_over,
)
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy, yaw_of

Floats = NDArray[np.float64]
Columns = dict[str, Column]
MOST_PITCH_DEG = 140.0
"""A vehicle's ends at 90; gimbals look back under themselves."""


@dataclass(frozen=True)
class AttitudeColumns:
    """Attitudes of the body (FRD in NED), a row each, NaN where one is not known.

    Attributes:
        quaternions: (N, 4) unit, (w, x, y, z).
        yaws_rad: (N,) clockwise seen from above.
        heights_m: (N,) of the camera over the floor.
        as_read: (N, 3) roll, pitch, yaw, rad, or (N, 4) quaternions, as the table has them.
        notes: units that were taken although the columns' names say others, a sentence each.
    """

    quaternions: Floats
    yaws_rad: Floats
    heights_m: Floats
    notes: tuple[str, ...] = ()
    as_read: Floats | None = None


def has_attitude(columns: Mapping[str, Column]) -> bool:
    """Whether columns by role are those of a whole attitude."""
    return set(ANGLES) <= columns.keys() or set(QUATERNION) <= columns.keys()


def require_attitude(table: Table, columns: Mapping[str, Column], way_out: str) -> None:
    """InputError where no column is one of an attitude; the error names the columns that are there."""
    if {*ANGLES, QUATERNION[0]}.isdisjoint(columns):
        raise InputError(table.path, f"has no attitude; {table.found}", way_out)


def read_times(table: Table, columns: Columns, given: Given, steps: Steps) -> tuple[Floats, tuple[str, ...]]:
    """(N,) s, NaN for blank cells, and a note where the unit is not the one that the column names.

    Raises:
        InputError: no such column, no numbers in it, or a unit that is not certain.
    """
    require(table, columns, ("time",))
    column = columns["time"]
    dates = seconds_of_dates(table.texts(column.name))
    if dates is not None:
        return dates, ()
    values = table.numbers(column.name, "write numbers, or dates as 2024-05-01 12:30:00.25")
    rest = parts_beside(table, column)
    if rest is not None:
        parts_s = rest[1] * table.numbers(rest[0])
        if ((parts_s >= 0.0) & (parts_s < 1.0) | np.isnan(parts_s)).all():
            return values + parts_s, ()
    unit = given.time_unit or _decided(table, clock_unit, values, column.unit, steps)
    named = column.unit or "s"
    note = f"column '{column.name}' is read as {UNIT_NAMES[unit]}, which alone fits its numbers"
    return values * TIME_UNITS[unit], (note,) if unit not in (named, given.time_unit) else ()


def read_attitudes(table: Table, columns: Columns, given: Given) -> AttitudeColumns:
    """The attitude of each row, from a quaternion or from roll, pitch and, if there, yaw.

    Raises:
        InputError: there is neither, a cell is no number, or the angles' unit is not certain.
    """
    rows = _read_attitudes(table, columns, given)
    return replace(rows, notes=(*rows.notes, *attitude_doubts(table, columns)))


def _read_attitudes(table: Table, columns: Columns, given: Given) -> AttitudeColumns:
    heights_m = _optional(table, columns, "height")
    if "height" in columns:
        heights_m *= LENGTH_UNITS[columns["height"].unit or "m"]
    if set(QUATERNION) <= columns.keys():
        return _from_quaternions(table, columns, heights_m)
    require(table, columns, ("roll", "pitch"))
    angles, notes = _angles_rad(table, columns, given)
    # The heading does not move the horizon: without it, zero serves.
    filled = np.column_stack([angles[:, :2], np.where(np.isfinite(angles[:, 2]), angles[:, 2], 0.0)])
    quaternions = np.full((len(filled), 4), np.nan)
    for index in np.flatnonzero(np.isfinite(filled).all(axis=-1)):
        quaternions[index] = quaternion_from_rpy(*filled[index].tolist())
    yaws = np.where(np.isfinite(angles[:, 2]), angles[:, 2], np.nan)
    return AttitudeColumns(quaternions, yaws, heights_m, notes, filled)


def convention_of(columns: Columns) -> Convention:
    """How the table's attitudes are read: FRD in NED, and those of ROS messages as FLU in ENU."""
    return Convention("flu", "z") if "qw" in columns and is_of_message(columns["qw"].name) else Convention()


def _from_quaternions(table: Table, columns: Columns, heights_m: Floats) -> AttitudeColumns:
    notes: tuple[str, ...] = ()
    raw = np.stack([table.numbers(columns[role].name) for role in QUATERNION], axis=-1)
    usable = usable_quaternions(raw)
    quaternions = np.full_like(raw, np.nan)
    quaternions[usable] = raw[usable] / np.linalg.norm(raw[usable], axis=-1, keepdims=True)
    if convention_of(columns) != Convention():
        quaternions = quaternions * [1.0, 1.0, -1.0, -1.0]
        notes = ("the quaternion is a ROS message's: body x forward, y left, z up; world z up",)
    yaws = [yaw_of(one) if np.isfinite(one).all() else math.nan for one in quaternions]
    return AttitudeColumns(quaternions, np.array(yaws), heights_m, notes, raw)


def _angles_rad(table: Table, columns: Columns, given: Given) -> tuple[Floats, tuple[str, ...]]:
    """(N, 3) roll, pitch, yaw, rad; columns of one named unit are judged together."""
    roles = [role for role in ("roll", "pitch", "yaw") if role in columns]
    raw = {role: table.numbers(columns[role].name) for role in roles}
    angles = np.full((len(table.rows), 3), np.nan)
    notes = []
    for named in {columns[role].unit for role in roles}:
        group = [role for role in roles if columns[role].unit == named]
        levels = [raw[role] for role in group if role != "yaw"]
        headings = [raw[role] for role in group if role == "yaw"]
        unit = given.angle_unit or _decided(table, angle_unit, levels, headings, named)
        if unit == "deg" and "pitch" in group and given.angle_unit is None:
            _check_pitch(table, columns["pitch"], raw["pitch"])
        for role in group:
            place = ("roll", "pitch", "yaw").index(role)
            in_degrees = unit == "deg" or (role == "yaw" and named is None and counts_degrees(raw[role]))
            angles[:, place] = np.deg2rad(raw[role]) if in_degrees else raw[role]
        if named and unit not in (named, given.angle_unit):
            names = ", ".join(columns[role].name for role in group)
            notes.append(f"{names} are read as degrees: as radians they are over a full turn")
    return angles, tuple(notes)


def _check_pitch(table: Table, column: Column, pitches_deg: Floats) -> None:
    """InputError for tenths of a degree and the like; turns that are counted on do not matter."""
    if often_over((pitches_deg + 180.0) % 360.0 - 180.0, MOST_PITCH_DEG):
        problem = f"'{column.name}' is over {MOST_PITCH_DEG:.0f} degrees, which no pitch is"
        raise InputError(table.path, problem, "divide tenths or hundredths of a degree, or --angle-unit deg")


def _optional(table: Table, columns: Columns, role: str) -> Floats:
    return table.numbers(columns[role].name) if role in columns else np.full(len(table.rows), np.nan)


def _decided(table: Table, decide: Callable[..., str], *numbers: Any) -> str:
    try:
        return decide(*numbers)
    except DoubtError as doubt:
        raise InputError(table.path, f"{table.found}; {doubt.looks}", doubt.hint) from None
