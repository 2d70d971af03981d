"""Bounds on what a camera file may cost: it may come from anywhere."""

import reprlib
from typing import Any

MAX_BYTES = 4 << 20
MAX_ALIASES = 10
"""Files that repeat a block by YAML's anchors do so once or twice; bombs need them nested by the dozen."""
MAX_DEPTH = 20
MAX_SCALAR = 4096
"""Characters of one value that is no text block; YAML 1.1's `1:1:1...` costs the square of its length."""
MAX_SIDE_PX = 20000
MAX_NUMBERS = 1000

_shown = reprlib.Repr()
_shown.maxlevel, _shown.maxdict, _shown.maxlist, _shown.maxtuple = 2, 3, 4, 4
_shown.maxstring = _shown.maxother = _shown.maxlong = 40


def shown(value: Any) -> str:
    """A value for a message, one short line however large the value is.

    Example:
        >>> shown([1, 2, 3, 4, 5, 6])
        '[1, 2, 3, 4, ...]'
    """
    try:
        text = _shown.repr(value)
    except ValueError:  # whole numbers of thousands of digits
        text = "a very large number"
    text = repr(text) if isinstance(value, int | float) else text
    return " ".join(text.split())[:80]
