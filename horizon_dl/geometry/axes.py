"""Names for the axes of a body: where x, y and z point, a letter each.

f forward, b backward, r right, l left, d down, u up: `frd` is the package's own body, `flu` that of ROS,
`rdf` a camera's optical axes. There are 24 of them that are right-handed.
"""

from itertools import product

import numpy as np
from numpy.typing import NDArray

_DIRECTIONS = {
    "f": (1.0, 0.0, 0.0),
    "b": (-1.0, 0.0, 0.0),
    "r": (0.0, 1.0, 0.0),
    "l": (0.0, -1.0, 0.0),
    "d": (0.0, 0.0, 1.0),
    "u": (0.0, 0.0, -1.0),
}
_ALIASES = {"optical": "rdf", "camera": "rdf", "ros": "flu"}
_WORDS = {"f": "forward", "b": "backward", "r": "right", "l": "left", "d": "down", "u": "up"}


def frd_from_axes(name: str, *, left_handed: bool = False) -> NDArray[np.float64]:
    """Rotation (3, 3) from a body with the named axes to FRD.

    Args:
        name: of the axes.
        left_handed: such axes are allowed, too; the matrix is then no rotation, but has a mirror in it.

    Raises:
        ValueError: not three letters of different axes, or not right-handed.

    Example:
        >>> frd_from_axes("flu").diagonal().tolist()
        [1.0, -1.0, -1.0]
    """
    letters = _ALIASES.get(name.strip().lower(), name.strip().lower())
    if len(letters) != 3 or any(letter not in _DIRECTIONS for letter in letters):
        raise ValueError("not three letters of f, b, r, l, d, u")
    rotation = np.array([_DIRECTIONS[letter] for letter in letters]).T
    handed = float(np.linalg.det(rotation))
    if abs(handed) < 0.5 or (handed < 0 and not left_handed):
        raise ValueError("its axes are not right-handed")
    return rotation


def axes_in_words(name: str) -> str:
    """What a name means.

    Example:
        >>> axes_in_words("flu")
        'x forward, y left, z up'
    """
    letters = _ALIASES.get(name.lower(), name.lower())
    return ", ".join(f"{axis} {_WORDS[letter]}" for axis, letter in zip("xyz", letters, strict=True))


def _right_handed(name: str) -> bool:
    try:
        frd_from_axes(name)
    except ValueError:
        return False
    return True


ALL_AXES: tuple[str, ...] = tuple(
    name for name in map("".join, product("fbrldu", repeat=3)) if _right_handed(name)
)
"""All 24, the usual ones first."""
