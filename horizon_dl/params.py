"""Parameters that a user may set: dataclasses whose fields know their range, read from config and card.

In files angles are degrees and their names end in `_deg`; inside they are radians, `_rad`. Free of pydantic,
as what flies reads its card with it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, TypeVar

P = TypeVar("P")

RANGE = "range"


def setting(default: float, low: float, high: float) -> Any:
    """A field of a parameter class that may be set from `low` to `high`, included; in the file's unit."""
    return field(default=default, metadata={RANGE: (low, high)})


def angle_deg(default: float, low: float, high: float) -> Any:
    """The same of an angle, `NAME_rad`, that files give in degrees."""
    return field(default=math.radians(default), metadata={RANGE: (low, high)})


@dataclass(frozen=True)
class Setting:
    """One value as files have it.

    Attributes:
        name: in files.
        attribute: inside.
        default: in the file's unit.
        low: least.
        high: most.
    """

    name: str
    attribute: str
    default: float
    low: float
    high: float

    @property
    def kind(self) -> type[int] | type[float]:
        """Whole numbers stay whole."""
        return int if isinstance(self.default, int) else float


def settings_of(params: type[Any] | Any) -> list[Setting]:
    """What may be set of a parameter class; of an instance, its values stand for the defaults."""
    found = []
    for one in fields(params):
        if RANGE in one.metadata:
            value: Any = getattr(params, one.name)  # a class has its defaults as attributes
            stem, is_angle = one.name.removesuffix("_rad"), one.name.endswith("_rad")
            name = f"{stem}_deg" if is_angle else one.name
            in_file = round(math.degrees(value), 9) if is_angle else value
            found.append(Setting(name, one.name, in_file, *one.metadata[RANGE]))
    return found


def values_of(params: Any) -> dict[str, float]:
    """The values by their names in files, ready for YAML and JSON.

    Example:
        >>> @dataclass(frozen=True)
        ... class Tilt:
        ...     most_rad: float = angle_deg(30.0, 0.0, 90.0)
        >>> values_of(Tilt())
        {'most_deg': 30.0}
    """
    return {one.name: one.default for one in settings_of(params)}


def read_params(params: type[P], values: object, where: str) -> P:
    """Parameters from the values of a file; what it lacks, as files of earlier versions do, is the default.

    Args:
        params: a class with fields made by `setting` or `angle_deg`.
        values: a mapping by names in files.
        where: the section's name, for messages.

    Raises:
        ValueError: no mapping, an unknown name, no number, or out of range; in one line.

    Example:
        >>> @dataclass(frozen=True)
        ... class Tilt:
        ...     most_rad: float = angle_deg(30.0, 0.0, 90.0)
        >>> read_params(Tilt, {"most_deg": 180.0}, "tilt").most_rad == math.pi
        Traceback (most recent call last):
        ValueError: tilt.most_deg = 180 is not from 0 to 90
    """
    if not isinstance(values, Mapping):
        raise ValueError(f"{where} is no section of values")
    known = {one.name: one for one in settings_of(params)}
    given: dict[str, float] = {}
    for name, value in values.items():
        if name not in known:
            raise ValueError(f"{where}.{name} is not known")
        one = known[name]
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{where}.{name} is no number")
        if not one.low <= value <= one.high or value != one.kind(value):
            raise ValueError(f"{where}.{name} = {value:g} is not from {one.low:g} to {one.high:g}")
        given[one.attribute] = math.radians(value) if name.endswith("_deg") else one.kind(value)
    return params(**given)
