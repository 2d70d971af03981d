"""A sink on a thread of its own that never holds up who logs: the newest frame wins."""

import threading

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.sink import Sink

Logged = tuple[Frame, Prediction, Ranged | None]


class NewestOnly:
    """Hands frames on to a sink by a thread; what is not taken in time is overwritten and counted.

    Attributes:
        dropped: frames that were overwritten.
        error: that ended the sink, or None; who logs goes on without it.
    """

    def __init__(self, sink: Sink) -> None:
        self.dropped = 0
        self.error: Exception | None = None
        self._sink = sink
        self._slot: Logged | None = None
        self._closed = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._work, name="viewer", daemon=True)
        self._thread.start()

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """Put a frame into the slot; takes microseconds."""
        with self._changed:
            self.dropped += self._slot is not None
            self._slot = (frame, prediction, ranges)
            self._changed.notify()

    def close(self) -> None:
        """Let the thread end with the last frame, and close the sink."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join(10.0)
        self._sink.close()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._slot is not None or self._closed)
                logged, self._slot = self._slot, None
            if logged is None:
                return
            try:
                self._sink.log(*logged)
            except Exception as error:  # a viewer's trouble is no reason to land
                self.error = error
                return
