"""The line through the offsets of windows of time: offset and drift between two clocks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.logs.clock.windows import LEAST_PAIRS, LONG_S, Peaks, Window

Floats = NDArray[np.float64]

MOST_DRIFT = 0.03
ON_LINE_S = 0.15


@dataclass(frozen=True)
class Line:
    """Frames' clock less log's: `offset_s + drift (t - time_s)` at the time t of a frame."""

    offset_s: float
    drift: float
    time_s: float

    def at(self, time_s: Floats | float) -> Floats | float:
        """The offset at frames' times, s."""
        return self.offset_s + self.drift * (time_s - self.time_s)

    def on_log_clock(self, log_time_s: float) -> tuple[float, float]:
        """The offset at a time of the log, s, and the frames' clock's excess over the log's, a share.

        Example:
            >>> Line(100.0, 0.5, 100.0).on_log_clock(0.0)
            (100.0, 1.0)
        """
        time_s = (log_time_s + self.offset_s - self.drift * self.time_s) / (1.0 - self.drift)
        return time_s - log_time_s, self.drift / (1.0 - self.drift)


def line_through(windows: Sequence[Peaks]) -> Line | None:
    """The line on which the windows' correlations are highest in sum; a level one through a single window."""
    windows = [one for one in windows if len(one.offsets_s)]
    if not windows:
        return None
    times_s = np.concatenate([np.full(len(one.offsets_s), one.time_s) for one in windows])
    offsets_s = np.concatenate([one.offsets_s for one in windows])
    first, second = np.nonzero(times_s[None, :] - times_s[:, None] >= LONG_S / 3)
    drifts = (offsets_s[second] - offsets_s[first]) / (times_s[second] - times_s[first])
    slow = np.abs(drifts) <= MOST_DRIFT
    # One line through each peak alone, level; one through every two peaks that are far apart.
    starts = np.concatenate([np.arange(len(times_s)), first[slow]])
    drifts = np.concatenate([np.zeros(len(times_s)), drifts[slow]])
    agreement = np.zeros(len(starts))
    for one in windows:
        wanted = offsets_s[starts] + drifts * (one.time_s - times_s[starts])
        near = np.abs(wanted[:, None] - one.offsets_s) <= ON_LINE_S
        agreement += np.where(near, one.correlations, 0.0).max(axis=1)
    best = int(agreement.argmax())
    return Line(float(offsets_s[starts[best]]), float(drifts[best]), float(times_s[starts[best]]))


def refined_line(window: Window, line: Line, frame_s: float) -> Line:
    """The line through the windows' refined offsets, weighted by correlation; level for one window."""
    parts = [one for one in window.split() if len(one.starts_s) >= LEAST_PAIRS]
    found = []
    for one in parts:
        offset_s = one.refined(float(line.at(one.time_s)), frame_s)
        if abs(offset_s - float(line.at(one.time_s))) > frame_s:  # it climbs on
            offset_s = one.refined(offset_s, frame_s)
        found.append((one.time_s, offset_s, max(one.correlation(offset_s), 0.0) ** 2))
    if not found:
        return line
    times_s, offsets_s, weights = np.array(found).T
    near = np.abs(offsets_s - line.at(times_s)) <= 2 * ON_LINE_S
    if near.sum() < 3:
        best = int(weights.argmax())
        return Line(float(offsets_s[best]), line.drift, float(times_s[best]))
    times_s, offsets_s, weights = times_s[near], offsets_s[near], weights[near] + 1e-9
    middle = float(np.average(times_s, weights=weights))
    drift, offset = np.polyfit(times_s - middle, offsets_s, 1, w=np.sqrt(weights))
    return Line(float(offset), float(drift), middle)
