"""A recording played at its own pace, as if it came from a camera."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.sources.camera import Clock
from horizon_dl.sources.pace import is_waited_for


def replay(
    recording: Recording,
    clock: Clock,
    *,
    speed: float = 1.0,
    loop: bool = False,
    wait: Callable[[float], object] = time.sleep,
) -> Iterator[Frame]:
    """The frames at the times at which they were taken, by the caller's clock.

    Those that cannot be read are left out.

    Args:
        recording: with attitudes, and heights if distances are needed.
        clock: monotonic seconds.
        speed: 2 plays twice as fast.
        loop: begin again at the end; the time of one frame passes between.
        wait: sleeps for some seconds.

    Raises:
        InputError: not one frame can be read.
    """
    times = np.array([header.time_s for header in recording.headers])
    gap_s = float(np.median(np.diff(times))) if len(times) > 1 else 0.1
    steps = np.diff(times, prepend=times[:1])
    waits = [step if is_waited_for(step) else gap_s for step in steps.tolist()]
    since_start_s = np.cumsum(waits) / speed
    start_s = clock()
    while True:
        any_read = False
        for index, after_s in enumerate(since_start_s.tolist()):
            try:
                frame = recording.read(index)
            except FrameError:
                continue
            any_read = True
            due_s = start_s + after_s
            wait(max(0.0, due_s - clock()))
            # The time at which it was taken, however late it was read: that time's attitude belongs to it.
            yield replace(frame, time_s=due_s)
        if not any_read:
            raise InputError(recording.name, "has no frame that can be read", "check its images")
        if not loop:
            return
        start_s += float(since_start_s[-1]) + gap_s / speed
