"""Which columns of a table are a gyroscope's and an accelerometer's, by the names that programs give them."""

from collections.abc import Sequence
from dataclasses import dataclass

from horizon_dl.data.tables.columns import UNIT_WORDS, words_of

RATES = (
    *("gyroscope", "gyro", "gyr", "angular_velocity", "ang_vel", "angvel", "angular_rate", "ang_rate"),
    *("omega", "w_rs", "w", "g", "gyro_adc", "rate", "rates"),
)
FORCES = (
    *("accelerometer", "g_f", "acceleration", "accel", "acc", "specific_force", "linear_acceleration"),
    *("lin_acc", "linacc", "a_rs", "a", "acc_smooth", "acc_adc"),
)
"""What names are but for axis and unit, best first: of Android's two accelerations the one with gravity."""
MEANS_ANOTHER = {
    *("user", "world", "earth", "ned", "enu", "gravity"),  # no specific force in the body's axes
    *("setpoint", "target", "desired", "des", "cmd", "command", "ref"),
    *("b", "bias", "std", "var", "cov", "covariance", "offset", "err", "error"),
}
AXES = {"x": 0, "y": 1, "z": 2, "0": 0, "1": 1, "2": 2}
ANGLES = {**{word: unit for word, unit in UNIT_WORDS.items() if unit in ("rad", "deg")}, "dps": "deg"}
IN_METRES = {"m", "ms2", "mps2"}
UNITS = {*ANGLES, *IN_METRES, "s", "s2", "1", "2", "sec", "per", "second", "g", "mg"}
"""Words that may stand behind an axis; any other one makes the column another thing."""
OF_MESSAGE = ".angular_velocity."
"""Of ROS, which counts radians."""

Triple = tuple[str, str, str]


@dataclass(frozen=True)
class InertialColumns:
    """Names of columns.

    Attributes:
        rates: of the gyroscope's x, y, z.
        forces: of the accelerometer's.
        rate_unit: of the angle in the rates, `rad` or `deg`, where their names tell it.
        in_metres: the forces' names say m/s^2.
    """

    rates: Triple
    forces: Triple
    rate_unit: str | None
    in_metres: bool


@dataclass(frozen=True)
class _Part:
    """A column's name in parts: `imu`, `gyro`, axis 0, and the unit's words."""

    prefix: str
    rank: int
    axis: int
    unit: str


def inertial_columns(names: Sequence[str]) -> InertialColumns | None:
    """The columns of a gyroscope and of an accelerometer of one device; None where either is not whole.

    Example:
        >>> inertial_columns(["t", "GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"]).forces
        ('AccX', 'AccY', 'AccZ')
        >>> inertial_columns(["t", "gx[deg/s]", "gy[deg/s]", "gz[deg/s]", "ax", "ay", "az"]).rate_unit
        'deg'
    """
    all_rates, all_forces = _triples(names, RATES), _triples(names, FORCES)
    pairs = [(rates, all_forces[prefix]) for prefix, rates in all_rates.items() if prefix in all_forces]
    if not pairs:
        return None
    rates, forces = pairs[0]
    return InertialColumns(rates, forces, _rate_unit(rates[0]), bool(IN_METRES & set(words_of(forces[0]))))


def _rate_unit(name: str) -> str | None:
    """`rad` or `deg`, as a column's name has it."""
    named = [ANGLES[word] for word in words_of(name) if word in ANGLES]
    return named[0] if named else "rad" if OF_MESSAGE in f".{name.lower()}" else None


def _triples(names: Sequence[str], stems: Sequence[str]) -> dict[str, Triple]:
    """By device the columns x, y, z of the best name that has all three alike."""
    found: dict[tuple[str, int, str], dict[int, str]] = {}
    for name in names:
        part = _part(name, stems)
        if part is not None:
            found.setdefault((part.prefix, part.rank, part.unit), {}).setdefault(part.axis, name)
    whole = [(key, axes) for key, axes in found.items() if len(axes) == 3]
    best: dict[str, Triple] = {}
    for (prefix, _, _), axes in sorted(whole, key=lambda one: one[0][1]):
        best.setdefault(prefix, (axes[0], axes[1], axes[2]))
    return best


def _part(name: str, stems: Sequence[str]) -> _Part | None:
    """A column's name in parts; None where it is none of a sensor of these names.

    Example:
        >>> _part("imu_gyro_y [rad s^-1]", RATES)
        _Part(prefix='imu', rank=1, axis=1, unit='rad_s_1')
        >>> _part("ax", FORCES).axis, _part("x_acc", FORCES).axis, _part("gyro_x_bias", RATES)
        (0, 0, None)
    """
    words = words_of(name)
    if MEANS_ANOTHER & set(words):
        return None
    if len(words) > 1 and words[0] in "xyz":
        words = [*words[1:], words[0]]
    for place, word in enumerate(words):
        ends = [(words[:place], word)] if place else []
        ends += [([*words[:place], word[:-1]], word[-1])] if word[:-1] and word[-1] in "xyz" else []
        unit = words[place + 1 :]
        for head, axis in ends:
            if axis in AXES and set(unit) <= UNITS:
                sensor, of_stem = _without_unit(head)
                found = _ranked(sensor, stems)
                if found is not None:
                    return _Part(found[0], found[1], AXES[axis], "_".join([*of_stem, *unit]))
    return None


def _ranked(sensor: list[str], stems: Sequence[str]) -> tuple[str, int] | None:
    """What stands before a sensor's name, and the name's place among those that are known."""
    whole = "_".join(sensor)
    fitting = [stem for stem in stems if whole == stem or (len(stem) > 1 and whole.endswith(f"_{stem}"))]
    if not fitting:
        return None
    stem = max(fitting, key=len)
    return whole.removesuffix(stem).rstrip("_"), stems.index(stem)


def _without_unit(words: list[str]) -> tuple[list[str], list[str]]:
    """Words, and the units at their end, as of `gyro_rad[0]`."""
    place = len(words)
    while place > 1 and words[place - 1] in UNITS:
        place -= 1
    return words[:place], words[place:]
