"""An online run in real time: every frame is predicted as it comes, learning takes what time is left."""

import queue
import threading
import time
from collections import deque
from collections.abc import Iterator
from typing import Any

from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError
from horizon_dl.online.run import OnlineRun, Seen
from horizon_dl.runtime.latency import Latencies
from horizon_dl.sources.pace import is_waited_for

Item = tuple[int, Frame | FrameError]

LEFT_OUT = "no time to learn"
MOST_WAITING = 16
"""Frames read ahead of their prediction; a recorded source waits then, a camera's driver drops."""
PREDICTIONS_A_STEP = 4
"""Where frames come too fast for any pause, learning still gets a step after so many predictions."""


class PacedFrames:
    """Frames at the times at which they were taken, read by a thread.

    Attributes:
        ended: all frames have been taken.
    """

    def __init__(self, items: Iterator[Item], speed: float) -> None:
        self.ended = False
        self._items, self._speed = items, speed
        self._queue: queue.Queue[tuple[float, Item] | Exception | None] = queue.Queue(MOST_WAITING)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._read, name="frames", daemon=True)
        self._thread.start()

    def take(self, timeout_s: float) -> tuple[float, Item] | None:
        """The next frame and when it came (`time.monotonic`), or None after the timeout.

        Raises:
            Exception: whatever ended the stream.
        """
        if self.ended:
            return None
        try:
            found = self._queue.get(timeout=timeout_s) if timeout_s else self._queue.get_nowait()
        except queue.Empty:
            return None
        if isinstance(found, Exception):
            raise found
        self.ended = found is None
        return found

    def stop(self) -> None:
        """Read no more."""
        self._stopped.set()
        self._thread.join(1.0)

    def _read(self) -> None:
        before_s: float | None = None
        due_s = time.monotonic()
        try:
            for item in self._items:
                if not isinstance(item[1], FrameError):  # what cannot be read is due with the frame before
                    if before_s is None:
                        due_s = time.monotonic()
                    elif is_waited_for(item[1].time_s - before_s):
                        due_s += (item[1].time_s - before_s) / self._speed
                    before_s = item[1].time_s
                self._stopped.wait(max(0.0, due_s - time.monotonic()))
                self._put((due_s, item))
                if self._stopped.is_set():
                    return
        except Exception as error:  # whatever a reader raises belongs to the caller
            self._put(error)
        self._put(None)

    def _put(self, item: tuple[float, Item] | Exception | None) -> None:
        while not self._stopped.is_set():
            try:
                return self._queue.put(item, timeout=0.1)
            except queue.Full:
                continue


class RealTime:
    """Turns between what has come, what is being learned, and what waits to be learned.

    Attributes:
        latencies: from a frame's arrival to its prediction.
    """

    def __init__(self, run: OnlineRun, frames: PacedFrames) -> None:
        self.latencies = Latencies()
        self._run, self._frames = run, frames
        self._open: deque[Seen] = deque()
        self._waiting: Seen | None = None
        self._learning: tuple[Seen, Iterator[None]] | None = None
        self._in_a_row = 0

    def turn(self) -> bool:
        """Do the most urgent thing; False when all is done."""
        idle = self._learning is None and self._waiting is None
        starved = not idle and self._in_a_row >= PREDICTIONS_A_STEP
        found = None if starved else self._frames.take(0.05 if idle else 0.0)
        if found is not None:
            came_s, (index, item) = found
            self._predict(came_s, index, item)
        elif not idle:
            self._learn()
        elif self._frames.ended:
            return False
        self._close()
        if self._learning is None and self._waiting is None:
            self._checkpoint()
        return True

    def _predict(self, came_s: float, index: int, item: Frame | FrameError) -> None:
        self._in_a_row += 1
        seen = self._run.see(index, item)
        self.latencies.add(time.monotonic() - came_s)
        self._open.append(seen)
        if seen.not_learned is None:
            self._leave_waiting()
            self._waiting = seen
        else:
            seen.settled = True

    def _learn(self) -> None:
        """Take one step, or begin with the frame that waits."""
        self._in_a_row = 0
        if self._learning is None:
            assert self._waiting is not None
            self._learning = (self._waiting, self._run.learning(self._waiting))
            self._waiting = None
            return
        seen, steps = self._learning
        if next(steps, self) is self:
            seen.settled, self._learning = True, None
            self._checkpoint()

    def _leave_waiting(self) -> None:
        """The frame that waits to be learned from will not be: a newer one is there."""
        if self._waiting is not None:
            self._waiting.not_learned, self._waiting.settled = LEFT_OUT, True
            self._waiting = None

    def _checkpoint(self) -> None:
        """Save if it is time: between two frames' steps; a frame that waits just then is not learned from."""
        self._close()
        if self._run.keeper.due(self._run.position):
            self._leave_waiting()
            self._close()
            self._run.save()

    def _close(self) -> None:
        while self._open and self._open[0].settled:
            self._run.settle(self._open.popleft())

    def finish(self) -> None:
        """Settle what is open when the run is stopped: what waits is left out."""
        if self._learning is not None:
            seen, steps = self._learning
            for _ in steps:
                pass
            seen.settled, self._learning = True, None
        self._leave_waiting()
        self._close()


def run_in_real_time(run: OnlineRun, speed: float) -> dict[str, Any]:
    """Predict every frame that is left when it comes; learn from the newest one whenever there is time.

    Args:
        run: its source's times count.
        speed: 2 plays twice as fast.

    Returns:
        milliseconds from arrival to prediction, and the speed.
    """
    frames = PacedFrames(run.items(), speed)
    real_time = RealTime(run, frames)
    try:
        while not run.stopped and real_time.turn():
            pass
    finally:
        run.source.stop()
        frames.stop()
    real_time.finish()
    return {"speed": speed, **real_time.latencies.summary()}
