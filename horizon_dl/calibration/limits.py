"""Bounds on what a camera file may hold: it may come from anywhere. Those of YAML are in `safe_yaml`."""

from typing import Any

from horizon_dl.data.safe_yaml import brief

MAX_BYTES = 4 << 20
MAX_DEPTH = 20
MAX_SIDE_PX = 20000
MAX_NUMBERS = 1000


def shown(value: Any) -> str:
    """A value for a message, in quotes if it is one value; never more than a short line.

    Example:
        >>> shown(3.5), shown([1, 2])
        ("'3.5'", 'a list of 2')
    """
    text = brief(value, 40)
    return f"'{text}'" if isinstance(value, int | float) else text
