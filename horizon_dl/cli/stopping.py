"""Ctrl-C and SIGTERM end a run in order; a second Ctrl-C at once."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def stopping(stop: Callable[[], Any]) -> Iterator[Callable[[], bool]]:
    """Call `stop` at the first signal; what is given tells whether there was one."""
    stopped = False

    def handle(number: int, _: Any) -> None:
        nonlocal stopped
        if stopped and number == signal.SIGINT:
            raise KeyboardInterrupt
        stopped = True
        stop()

    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: stopped
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
