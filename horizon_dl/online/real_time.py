"""An online run in real time: every frame is predicted as it comes, learning takes what time is left."""

import queue
import threading
import time
from collections import deque
from collections.abc import Iterator
from typing import Any

from horizon_dl.data.capture.stream import Arrival
from horizon_dl.online.run import OnlineRun, Seen
from horizon_dl.runtime.latency import Latencies

LEFT_OUT = "no time to learn"
MOST_WAITING = 16
"""Frames read ahead of their prediction; a recorded source waits then, a camera's driver drops."""
PREDICTIONS_A_STEP = 4
"""Where frames come too fast for any pause, learning still gets a step after so many predictions."""


class Arrivals:
    """Frames at the times at which they were taken, read by a thread.

    Attributes:
        ended: all frames have been taken.
    """

    def __init__(self, arrivals: Iterator[Arrival], speed: float) -> None:
        self.ended = False
        self._arrivals, self._speed = arrivals, speed
        self._queue: queue.Queue[tuple[float, Arrival] | Exception | None] = queue.Queue(MOST_WAITING)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._read, name="arrivals", daemon=True)
        self._thread.start()

    def take(self, timeout_s: float) -> tuple[float, Arrival] | None:
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
        first_s: float | None = None
        start_s = time.monotonic()
        try:
            for arrival in self._arrivals:
                if first_s is None:
                    first_s, start_s = arrival.time_s, time.monotonic()
                due_s = start_s + (arrival.time_s - first_s) / self._speed
                self._stopped.wait(max(0.0, due_s - time.monotonic()))
                self._put((max(due_s, start_s), arrival))
                if self._stopped.is_set():
                    return
        except Exception as error:  # whatever a reader raises belongs to the caller
            self._put(error)
        self._put(None)

    def _put(self, item: tuple[float, Arrival] | Exception | None) -> None:
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

    def __init__(self, run: OnlineRun, arrivals: Arrivals) -> None:
        self.latencies = Latencies()
        self._run, self._arrivals = run, arrivals
        self._open: deque[Seen] = deque()
        self._waiting: Seen | None = None
        self._learning: tuple[Seen, Iterator[None]] | None = None
        self._in_a_row = 0

    def turn(self) -> bool:
        """Do the most urgent thing; False when all is done."""
        idle = self._learning is None and self._waiting is None
        starved = not idle and self._in_a_row >= PREDICTIONS_A_STEP
        found = None if starved else self._arrivals.take(0.05 if idle else 0.0)
        if found is not None:
            self._predict(*found)
        elif not idle:
            self._learn()
        elif self._arrivals.ended:
            return False
        self._close()
        if self._learning is None and self._waiting is None:
            self._checkpoint()
        return True

    def _predict(self, came_s: float, arrival: Arrival) -> None:
        self._in_a_row += 1
        seen = self._run.see(arrival)
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
        run: its stream's times count.
        speed: 2 plays twice as fast.

    Returns:
        milliseconds from arrival to prediction, and the speed.
    """
    arrivals = Arrivals(run.arrivals(), speed)
    real_time = RealTime(run, arrivals)
    try:
        while not run.stopped and real_time.turn():
            pass
    finally:
        run.stream.stop()
        arrivals.stop()
    real_time.finish()
    return {"speed": speed, **real_time.latencies.summary()}
