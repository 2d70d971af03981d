"""Helper processes: those that a launcher starts beside the first one, to train together with it."""

import os

NUMBERS = ("LOCAL_RANK", "NODE_RANK", "RANK")
"""Variables in which Lightning's launcher and torchrun tell a process its number."""


def is_helper() -> bool:
    """Whether this process only computes: the first one writes and speaks."""
    return any(os.environ.get(name, "0") != "0" for name in NUMBERS)
