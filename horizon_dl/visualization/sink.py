"""What takes what was found in a frame: files, films, pages and viewers.

A new sink is one module with these two methods, and one line where a verb opens its sinks.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged


class Sink(Protocol):
    """Takes one frame after the other.

    Example:
        >>> class Count:
        ...     frames = 0
        ...     def log(self, frame, prediction, ranges):
        ...         self.frames += 1
        ...     def close(self): ...
    """

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """Take what was found in a frame; `ranges` is None without attitude or camera."""
        ...

    def close(self) -> None:
        """No more frames come: write what is not written yet."""
        ...


class Sinks:
    """Several sinks as one."""

    def __init__(self, sinks: Sequence[Sink]) -> None:
        self.sinks = sinks

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        for sink in self.sinks:
            sink.log(frame, prediction, ranges)

    def close(self) -> None:
        """Close all, even where one cannot be closed."""
        errors = []
        for sink in self.sinks:
            try:
                sink.close()
            except Exception as error:  # the others' files must not be lost with it
                errors.append(error)
        if errors:
            raise errors[0]


class EveryNth:
    """A sink that hands on the first frame and every Nth after it.

    Example:
        >>> from types import SimpleNamespace
        >>> seen = []
        >>> sink = EveryNth(SimpleNamespace(log=lambda *frame: seen.append(frame)), 3)
        >>> for number in range(7): sink.log(number, None, None)
        >>> [frame[0] for frame in seen]
        [0, 3, 6]
    """

    def __init__(self, sink: Sink, every: int) -> None:
        self._sink, self._every, self._count = sink, every, 0

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        if self._count % self._every == 0:
            self._sink.log(frame, prediction, ranges)
        self._count += 1

    def close(self) -> None:
        """See `Sink`."""
        self._sink.close()


@contextmanager
def closing(sinks: Sequence[Sink]) -> Iterator[Sinks]:
    """The sinks as one, closed at the end."""
    together = Sinks(sinks)
    try:
        yield together
    finally:
        together.close()
