"""The pace at which recorded frames are played."""

LONGEST_WAIT_S = 60.0
"""A longer gap between two frames is a clock that was set, and is not waited for."""


def is_waited_for(gap_s: float) -> bool:
    """Whether the next frame is due so many seconds after the one before, and not at once.

    Example:
        >>> is_waited_for(0.1), is_waited_for(3600.0), is_waited_for(-3600.0)
        (True, False, False)
    """
    return 0.0 <= gap_s <= LONGEST_WAIT_S
