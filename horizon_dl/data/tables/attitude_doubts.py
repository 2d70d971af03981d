"""What speaks against the attitude of a table: it may be another body's, a trajectory's, or no estimate."""

from collections.abc import Iterator, Mapping

import numpy as np

from horizon_dl.data.doubt import Doubt
from horizon_dl.data.tables.columns import Column, is_of_message, words_of
from horizon_dl.data.tables.find_columns import QUATERNION, columns_beside, gimbal_columns
from horizon_dl.data.tables.table import Table

POSITIONS = ({"tx", "ty", "tz"}, {"px", "py", "pz"}, {"p_x", "p_y", "p_z"}, {"pos_x", "pos_y", "pos_z"})


def attitude_doubts(table: Table, columns: Mapping[str, Column]) -> Iterator[Doubt]:
    """Doubts about the attitude that the columns, by role, hold."""
    by_quaternion = set(QUATERNION) <= columns.keys()
    first = columns["qw" if by_quaternion else "roll"].name
    others = columns_beside(table, dict(columns))
    if others:
        yield Doubt(
            f"the attitude is the camera's or gimbal's, of '{first}' and so on, and not that of "
            f"'{others[0]}' beside it; remove the columns that do not turn with the camera"
        )
    gimbal = [] if others or words_of(first)[0] == "gimbal" else gimbal_columns(table)
    if gimbal:
        yield Doubt(
            f"the attitude is the vehicle's, of '{first}' and so on, and '{gimbal[0]}' beside it says that "
            "the camera hangs in a gimbal; name the gimbal's columns gimbal_roll_deg and gimbal_pitch_deg"
        )
    if turns_nothing(table, columns):
        yield Doubt(
            "the quaternion turns nothing in any row: it may be no estimate, but what a driver leaves blank"
        )
    names = {"_".join(words_of(name)) for name in table.names}
    if by_quaternion and not is_of_message(first) and any(one <= names for one in POSITIONS):
        yield Doubt(
            "the quaternion stands beside positions, as of a trajectory, whose body and world are seldom FRD "
            "and NED, as which it is read; check-data finds them, or --convention 'flu z-up', 'rdf z-up', ..."
        )


def turns_nothing(table: Table, columns: Mapping[str, Column]) -> bool:
    """Whether a quaternion turns nothing in any row, as drivers write that have no estimate."""
    if not set(QUATERNION) <= columns.keys():
        return False
    vectors = np.stack([table.numbers(columns[role].name) for role in QUATERNION[1:]])
    return bool(np.isfinite(vectors).any() and (np.nan_to_num(vectors) == 0.0).all())
