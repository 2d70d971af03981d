"""The newest frame wins: a slow model skips frames and never lags behind."""

import threading
from collections.abc import Callable, Iterator

from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError


class NewestFrame:
    """A slot for one frame, filled by a thread; what is not taken in time is overwritten and counted.

    Args:
        frames: as they come; those that cannot be read are left out.
        on_frame: called at each.
        stop: ends `frames` from another thread.

    Attributes:
        ended: the source has no more.
        error: why the source ended, or None.
        seen: frames that came.
        skipped: frames that were overwritten.
    """

    def __init__(
        self,
        frames: Iterator[Frame | FrameError] | Iterator[Frame],
        on_frame: Callable[[], None],
        stop: Callable[[], None] = lambda: None,
    ) -> None:
        self.ended = False
        self.error: Exception | None = None
        self.seen = self.skipped = 0
        self._frames, self._on_frame, self._stop_source = frames, on_frame, stop
        self._slot: Frame | None = None
        self._filled = threading.Condition()
        self._stopped = False
        self._thread = threading.Thread(target=self._fill, name="frames", daemon=True)

    def start(self) -> None:
        """Begin to read."""
        self._thread.start()

    def take(self, timeout_s: float) -> Frame | None:
        """The newest frame not taken before, or None after the timeout."""
        with self._filled:
            self._filled.wait_for(lambda: self._slot is not None or self.ended, timeout_s)
            frame, self._slot = self._slot, None
            return frame

    def stop(self) -> None:
        """Read no more."""
        self._stopped = True
        self._stop_source()
        self._thread.join(1.0)

    def _fill(self) -> None:
        try:
            for frame in self._frames:
                if self._stopped:
                    break
                if not isinstance(frame, FrameError):
                    self._put(frame)
        except Exception as error:  # whatever a camera's driver raises: the loop has to learn of it
            self.error = error
        with self._filled:
            self.ended = True
            self._filled.notify()

    def _put(self, frame: Frame) -> None:
        self._on_frame()
        with self._filled:
            self.seen += 1
            self.skipped += self._slot is not None
            self._slot = frame
            self._filled.notify()
