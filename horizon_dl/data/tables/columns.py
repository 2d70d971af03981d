"""What the columns of a table are: one list of the names that programs give them, and units in names."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from horizon_dl.data.tables.table import Table
from horizon_dl.errors import InputError

# Per role the name in this project's own files, and the keys under which others know it, best first.
OWN_NAMES = {
    "image": "image",
    "time": "time_s",
    "roll": "roll_rad",
    "pitch": "pitch_rad",
    "yaw": "yaw_rad",
    "height": "height_m",
    "qw": "qw",
    "qx": "qx",
    "qy": "qy",
    "qz": "qz",
}
KEYS = {
    "image": "image filename file_name image_file image_filename image_name image_path imagepath file_path "
    "filepath file path img img_name img_file img_path picture photo frame_file frame_name source_file "
    "sourcefile rgb name",
    "time": "time timestamp time_stamp t stamp elapsed elapsed_time time_elapsed seconds_elapsed unix "
    "unix_time unixtime unix_timestamp epoch epoch_time time_boot time_since_boot utc utc_time "
    "header_stamp time_utc time_unix datetime date_time",
    "roll": "roll phi roll_angle angle_roll bank",
    "pitch": "pitch ptch theta pitch_angle angle_pitch",
    "yaw": "yaw psi heading hdg yaw_angle angle_yaw azimuth",
    "height": "height agl height_agl altitude_agl alt_agl height_above_ground relative_altitude "
    "altitude_relative rel_alt relative_alt alt_rel",
    "qw": "qw q_w q0 q_0 quat_w quaternion_w quat_0 q_real qi orientation_w",
    "qx": "qx q_x q1 q_1 quat_x quaternion_x quat_1 orientation_x",
    "qy": "qy q_y q2 q_2 quat_y quaternion_y quat_2 orientation_y",
    "qz": "qz q_z q3 q_3 quat_z quaternion_z quat_3 orientation_z",
}
PREFIXES = (
    *("att", "attitude", "body", "vehicle", "drone", "uav", "robot", "imu", "pose", "camera", "cam"),
    *("header", "rosbag", "frame", "image", "log", "sensor", "system", "device"),
)
SELDOM_TIMES = (
    *("offset_time", "clock_offset_time", "fly_time", "osd_fly_time", "update_time", "custom_update_time"),
    *("time_startup", "logging_time", "logging_time_txt", "time_since_start", "time_since_start_in"),
    *("timestamp_since_reboot", "cts", "ts"),
)
"""Keys of single programs, which count where no other column is a time."""
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "ft": 0.3048}
UNIT_WORDS = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("ms", "msec", "msecs", "millis", "millisec", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("us", "usec", "usecs", "µs", "μs", "micros", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("ns", "nsec", "nsecs", "nanos", "nanosec", "nanosecond", "nanoseconds"), "ns"),
    **dict.fromkeys(("rad", "rads", "radian", "radians"), "rad"),
    **dict.fromkeys(("deg", "degs", "degree", "degrees"), "deg"),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("cm",), "cm"),
    **dict.fromkeys(("mm",), "mm"),
    **dict.fromkeys(("ft", "feet", "foot"), "ft"),
}
UNITS_OF = {
    "time": frozenset(TIME_UNITS),
    "height": frozenset(LENGTH_UNITS),
    **dict.fromkeys(("roll", "pitch", "yaw"), frozenset(("rad", "deg"))),
}


PARTS_OF_SECONDS = {
    **dict.fromkeys(("nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds"), 1e-9),
    **dict.fromkeys(("usec", "usecs", "microsec", "microsecs", "microseconds"), 1e-6),
}
"""How a stamp names what its whole seconds lack, and its unit in s."""


@dataclass(frozen=True)
class Column:
    """A column of a table: its name as written, and the unit in that name, or None."""

    name: str
    unit: str | None = None


def words_of(name: str) -> list[str]:
    """A column's name as words of small letters.

    Example:
        >>> words_of("Time [µs]"), words_of("rollDeg"), words_of("q[0]"), words_of("Pitch (°)")
        (['time', 'µs'], ['roll', 'deg'], ['q', '0'], ['pitch', 'deg'])
    """
    apart = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name.replace("°", " deg "))
    return [word for word in re.split(r"[^a-z0-9µμ]+", apart.lower()) if word]


def match(name: str, role: str) -> tuple[int, Column] | None:
    """How well a column's name fits a role (0 is best), and the column; None where it does not.

    Example:
        >>> match("Timestamp (ns)", "time")
        (1, Column(name='Timestamp (ns)', unit='ns'))
    """
    keys = KEYS[role].split()
    words = words_of(name)
    plain = "_".join(words)
    if role == "time" and plain in UNIT_WORDS and len(plain) > 2:  # a column named `seconds`
        return len(keys), Column(name, UNIT_WORDS[plain])
    for place in (*range(len(words) - 1, 0, -1), None):
        unit = None if place is None else UNIT_WORDS.get(words[place])
        if place is not None and unit not in UNITS_OF.get(role, ()):
            continue
        rest = words if place is None else words[:place] + words[place + 1 :]
        key, bare = "_".join(rest), "_".join(rest[1:])
        if key in keys:
            return keys.index(key), Column(name, unit)
        if role == "time" and key in SELDOM_TIMES:
            return 3 * len(keys) + SELDOM_TIMES.index(key), Column(name, unit)
        if rest and rest[0] in PREFIXES and bare in keys:
            return len(keys) + keys.index(bare), Column(name, unit)
        if is_of_message(name):
            last = "_".join(rest[-2:])
            return (2 * len(keys), Column(name, unit)) if last in keys else None
    return None


def is_of_message(name: str) -> bool:
    """Whether a column is of the quaternion of a ROS message, as `field.pose.pose.orientation.x`."""
    return words_of(name)[-2:-1] == ["orientation"]


def best_columns(names: Sequence[str]) -> dict[str, Column]:
    """Columns by role; where several fit a role, the better name, then the one with a unit."""
    found = {}
    for role in KEYS:
        fitting = [(match(name, role), place) for place, name in enumerate(names)]
        ranked = sorted(
            (fit[0], fit[1].unit is None, place, fit[1].name, fit[1].unit) for fit, place in fitting if fit
        )
        if ranked:
            *_, name, unit = ranked[0]
            found[role] = Column(name, unit)
    return found


def require(table: Table, columns: dict[str, Column], roles: tuple[str, ...]) -> None:
    """InputError where a role has no column; the error names the columns that are there."""
    missing = [OWN_NAMES[role] for role in roles if role not in columns]
    if missing:
        problem = f"has no column{'s' * (len(missing) > 1)} '{', '.join(missing)}'; {table.found}"
        needed = ", ".join(OWN_NAMES[role] for role in roles)
        raise InputError(table.path, problem, f"needed are {needed}")


def parts_beside(table: Table, column: Column) -> tuple[str, float] | None:
    """The column of what whole seconds lack, as `stamp.nsecs` beside `stamp.secs`, and its unit in s.

    Example:
        >>> from pathlib import Path
        >>> table = Table(Path("log.csv"), ("stamp.sec", "stamp.nanosec"), ())
        >>> parts_beside(table, Column("stamp.sec", "s"))
        ('stamp.nanosec', 1e-09)
    """
    *head, unit = words_of(column.name)
    if UNIT_WORDS.get(unit) != "s":
        return None
    names = ((name, words_of(name)) for name in table.names)
    beside = ((name, words) for name, words in names if words[:-1] == head)
    return next(((name, size) for name, words in beside if (size := PARTS_OF_SECONDS.get(words[-1]))), None)
