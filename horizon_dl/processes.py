"""Helper processes: those that a launcher starts beside the first one, to train together with it."""

import os

NUMBERS = ("LOCAL_RANK", "NODE_RANK", "RANK")
"""Variables in which Lightning's launcher and torchrun tell a process its number."""
MEETING_PLACE = "MASTER_ADDR"
"""Both also say where the processes meet; a number alone is left over from something else."""
VERBS = frozenset({"train", "compare"})
"""What may be done in several processes."""

_helper = False


def is_helper() -> bool:
    """Whether this process only computes: the first one writes and speaks."""
    return _helper


def begin(verb: str) -> None:
    """Decide whether this process, which runs a verb of the command line, is a helper.

    A number that does not come from a launcher is forgotten: Lightning would take it for one.
    """
    global _helper
    launched = verb in VERBS and MEETING_PLACE in os.environ
    _helper = launched and any(os.environ.get(name, "0") != "0" for name in NUMBERS)
    if not launched:
        for name in NUMBERS:
            os.environ.pop(name, None)
