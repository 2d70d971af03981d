"""Ctrl-C and SIGTERM end a run in order; a second Ctrl-C at once."""

import signal
import threading
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

    if threading.current_thread() is not threading.main_thread():
        yield lambda: False  # signals go to the main thread alone
        return
    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: stopped
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
