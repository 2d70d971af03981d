"""Which columns of a table are a gyroscope's and an accelerometer's, by the names that programs give them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from horizon_dl.data.tables.columns import words_of

RATES = (
    *("gyroscope", "gyro", "gyr", "angular_velocity", "ang_vel", "angvel", "angular_rate", "ang_rate"),
    *("rotation_rate", "gyro_rotation", "omega", "w_rs", "w", "g", "gyro_adc", "rate", "rates"),
)
FORCES = (
    *("accelerometer", "acceleration", "accel", "acc", "specific_force", "linear_acceleration", "lin_acc"),
    *("linacc", "a_rs", "a", "g_f", "acc_smooth", "acc_adc"),
)
"""What names are but for axis and unit, best first: of Android's two accelerations the one with gravity."""
WITHOUT_GRAVITY = "user"
"""A word of iOS's acceleration that has none."""
AXES = {"x": 0, "y": 1, "z": 2, "0": 0, "1": 1, "2": 2}
DEGREES, RADIANS = {"deg", "degs", "degree", "degrees", "dps"}, {"rad", "rads", "radian", "radians"}
UNITS = {*DEGREES, *RADIANS, "m", "s", "s2", "ms2", "g"}
OF_MESSAGE = ".angular_velocity."
"""Of ROS, which counts radians."""

Triple = tuple[str, str, str]


@dataclass(frozen=True)
class InertialColumns:
    """Names of columns.

    Attributes:
        rates: of the gyroscope's x, y, z.
        forces: of the accelerometer's.
        rate_unit: of the angle in the rates, where their names tell it.
    """

    rates: Triple
    forces: Triple
    rate_unit: Literal["rad", "deg"] | None


def inertial_columns(names: Sequence[str]) -> InertialColumns | None:
    """The columns of a gyroscope and of an accelerometer; None where either is not whole.

    Example:
        >>> inertial_columns(["t", "GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"]).forces
        ('AccX', 'AccY', 'AccZ')
        >>> inertial_columns(["t", "gx[deg/s]", "gy[deg/s]", "gz[deg/s]", "ax", "ay", "az"]).rate_unit
        'deg'
    """
    rates, forces = _triple(names, RATES), _triple(names, FORCES)
    if rates is None or forces is None:
        return None
    return InertialColumns(rates, forces, _rate_unit(rates[0]))


def _rate_unit(name: str) -> Literal["rad", "deg"] | None:
    words = set(words_of(name))
    if words & DEGREES:
        return "deg"
    return "rad" if words & RADIANS or OF_MESSAGE in f".{name.lower()}" else None


def _triple(names: Sequence[str], stems: Sequence[str]) -> Triple | None:
    """The columns x, y, z of the best name that has all three."""
    found: dict[tuple[int, str], dict[int, str]] = {}
    for name in names:
        stem, axis = _stem_and_axis(name)
        fitting = [place for place, one in enumerate(stems) if _is(stem, one)]
        if axis is not None and fitting:
            found.setdefault((fitting[0], stem), {}).setdefault(axis, name)
    whole = [key for key, axes in found.items() if len(axes) == 3]
    if not whole:
        return None
    axes = found[min(whole, key=lambda key: key[0])]
    return axes[0], axes[1], axes[2]


def _is(stem: str, known: str) -> bool:
    """Whether a name without its axis is a known one, or one behind other words, as `imu_gyro`."""
    return stem == known or (len(known) > 1 and stem.endswith(f"_{known}"))


def _stem_and_axis(name: str) -> tuple[str, int | None]:
    """A column's name without axis and unit, and the axis; None: it has none.

    Example:
        >>> _stem_and_axis("w_RS_S_x [rad s^-1]"), _stem_and_axis("gyro_rad[0]"), _stem_and_axis("ax")
        (('w_rs', 0), ('gyro', 0), ('a', 0))
        >>> _stem_and_axis("x_gyro"), _stem_and_axis("userAccelerationZ(G)")
        (('gyro', 0), ('', None))
    """
    words = words_of(name)
    if WITHOUT_GRAVITY in words:
        return "", None
    if len(words) > 1 and words[0] in "xyz":
        words = [*words[1:], words[0]]
    for place, word in enumerate(words):
        if place and word in AXES:
            return _stem(words[:place]), AXES[word]
        head = _stem([*words[:place], word[:-1]])
        if word[-1] in "xyz" and any(_is(head, known) for known in (*RATES, *FORCES)):
            return head, AXES[word[-1]]
    return "", None


def _stem(words: list[str]) -> str:
    """Words without the units at their end."""
    while len(words) > 1 and words[-1] in UNITS:
        words = words[:-1]
    return "_".join(words)
