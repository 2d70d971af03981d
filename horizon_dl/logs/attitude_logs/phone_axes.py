"""A phone's axes: x to the right, y to its top, z out of the screen; its rear camera looks along -z."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

UPRIGHT = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""From the phone's axes, held upright, to the camera's forward, right, down."""

QUARTER_TURNS = (
    np.eye(3),  # upright
    np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),  # its right side up
    np.diag([-1.0, -1.0, 1.0]),  # upside down
    np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),  # its left side up
)
"""What turns the phone's axes so that the side that is up becomes the top."""


def frd_from_phone(up: ArrayLike) -> NDArray[np.float64]:
    """(3, 3) from the phone's axes to the rear camera's forward, right, down, of the picture as it is shown.

    A phone shows a film upright as it was held at the start: of the four ways, the one with the least roll.

    Args:
        up: (3,) mean of the world's up, or of the accelerometer, in the phone's axes.

    Example:
        >>> frd_from_phone([0.0, 9.8, 0.0]) @ [0.0, 1.0, 0.0]  # the top is up: against down
        array([ 0.,  0., -1.])
    """
    up = np.asarray(up, np.float64)
    turn = max(QUARTER_TURNS, key=lambda turn: float((turn @ up)[1]))
    return np.asarray(UPRIGHT @ turn)
