"""Which columns of a table are meant where it holds the attitude of a vehicle and that of its camera."""

from collections.abc import Sequence

from horizon_dl.data.tables.columns import Column, best_columns, words_of
from horizon_dl.data.tables.table import Table

CAMERA_PREFIXES = ("gimbal", "camera", "cam", "frame")
"""How columns of a camera's own attitude begin."""
ANGLES, QUATERNION = ("roll", "pitch"), ("qw", "qx", "qy", "qz")


def find_columns(table: Table) -> dict[str, Column]:
    """The columns of a table by role; of two attitudes the camera's, as pictures turn with it."""
    own, of_camera = best_columns(table.names), _camera_columns(table)
    if not of_camera or all(own.get(role) == column for role, column in of_camera.items()):
        return own
    others = {role: column for role, column in own.items() if role not in (*ANGLES, "yaw", *QUATERNION)}
    return others | of_camera


def columns_beside(table: Table, columns: dict[str, Column]) -> list[str]:
    """Columns of another attitude than the one that was found: the vehicle's beside the camera's."""
    others = best_columns(table.names)
    names = [others[role].name for role in (*ANGLES, "qw") if role in others]
    return [name for name in names if name not in {column.name for column in columns.values()}]


def gimbal_columns(table: Table) -> list[str]:
    """Columns of a gimbal's angle, whole or not, as far as they tell one."""
    named = [name for name in table.names if words_of(name)[:1] == ["gimbal"]]
    angles = [name for name in named if {*ANGLES, "tilt"} & set(words_of(name))]
    return [name for name in angles if _tells(table, "gimbal", [name])]


def _camera_columns(table: Table) -> dict[str, Column]:
    """Those of a camera's or gimbal's attitude; none where they are not whole, or tell nothing."""
    for prefix in CAMERA_PREFIXES:
        names = {rest: name for name in table.names if (rest := _without(name, prefix))}
        own = {
            role: Column(names[found.name], found.unit) for role, found in best_columns(list(names)).items()
        }
        for needed in (QUATERNION, ANGLES):
            if own.keys() >= set(needed) and _tells(table, prefix, [own[role].name for role in needed]):
                return {role: own[role] for role in (*needed, "yaw") if role in own}
    return {}


def _tells(table: Table, prefix: str, names: Sequence[str]) -> bool:
    """Whether columns are an attitude: a gimbal may hold one angle; one angle of a camera is its mount's."""
    cells = [table.texts(name) for name in names]
    if prefix == "gimbal":
        return any(cell.strip("-0. ") for column in cells for cell in column)
    return any(len(set(column)) > 1 for column in cells)


def _without(name: str, prefix: str) -> str:
    """A column's name without the word that it begins with; empty where it does not."""
    words = words_of(name)
    return "_".join(words[1:]) if len(words) > 1 and words[0] == prefix else ""
