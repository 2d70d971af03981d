"""Work on a thread of its own that never holds up who hands it over: the newest item wins."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.sink import Sink

T = TypeVar("T")


class NewestSlot(Generic[T]):
    """A slot for one item and a thread that works on it; what is not taken in time is overwritten.

    Attributes:
        dropped: items that were overwritten.
        error: that ended the work, or None; who puts goes on without it.
    """

    def __init__(self, work: Callable[[T], None]) -> None:
        self.dropped = 0
        self.error: Exception | None = None
        self._work = work
        self._slot: list[T] = []
        self._closed = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="viewer", daemon=True)
        self._thread.start()

    def put(self, item: T) -> None:
        """Put an item into the slot; takes microseconds."""
        with self._changed:
            self.dropped += len(self._slot)
            self._slot = [item]
            self._changed.notify()

    def close(self) -> None:
        """Let the thread end with the last item."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join(10.0)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._slot or self._closed)
                items, self._slot = self._slot, []
            if not items:
                return
            try:
                self._work(items[0])
            except Exception as error:  # a viewer's trouble is no reason to land
                self.error = error
                return


class NewestOnly:
    """A sink that hands frames on to another by a thread; see `NewestSlot`."""

    def __init__(self, sink: Sink) -> None:
        self._sink = sink
        self.slot: NewestSlot[tuple[Frame, Prediction, Ranged | None]] = NewestSlot(self._take)

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        self.slot.put((frame, prediction, ranges))

    def close(self) -> None:
        """See `Sink`."""
        self.slot.close()
        self._sink.close()

    def _take(self, logged: tuple[Frame, Prediction, Ranged | None]) -> None:
        self._sink.log(*logged)
