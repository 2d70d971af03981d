"""Finds a recording's clock against its log's, from its pictures."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError
from horizon_dl.logs.clock.clock_fit import ClockFit, fit_clock
from horizon_dl.logs.clock.logged_turns import knows_heading, logged_turns, mean_up
from horizon_dl.logs.clock.seen_turns import seen_turn, small_camera, small_grey
from horizon_dl.logs.clock.windows import WINDOW_S, Window

Floats = NDArray[np.float64]

MOST_PICTURES = 2400
WINDOWS = 8
NEAREST_S = 30.0
"""Where film and log overlap already, offsets further away are not tried."""


def find_clock(recording: Recording, log: AttitudeLog | None = None) -> ClockFit | None:
    """Offset and drift between a recording's pictures and its log; None where they do not tell.

    Args:
        recording: with a camera.
        log: on any clock; None: the recording's own, on which zero is then the offset in use.
    """
    log = recording.attitudes if log is None else log
    if log is None or recording.length < 3:
        return None
    times_s = np.array([header.time_s for header in recording.headers])
    indices = pictures_to_compare(times_s)
    turns = _seen(recording, indices)
    pairs = np.flatnonzero(np.diff(indices) == 1)
    if not len(pairs):
        return None
    mount = recording.mount_rpy_rad or (0.0, 0.0, 0.0)
    logged = logged_turns(log, mount)
    if not knows_heading(log):
        # What turns about the upright shows in the pictures alone: left out on both sides.
        up = mean_up(log, mount)
        level = np.eye(3) - np.outer(up, up)
        turns, logged = turns @ level, logged @ level
    starts_s, ends_s = times_s[indices[pairs]], times_s[indices[pairs] + 1]
    moving = ends_s > starts_s
    window = Window(starts_s[moving], ends_s[moving], turns[pairs][moving], log.times_s, logged)
    overlap = times_s[0] <= log.times_s[-1] and times_s[-1] >= log.times_s[0]
    return fit_clock(window, NEAREST_S if overlap else None)


def pictures_to_compare(times_s: Floats, most: int = MOST_PICTURES) -> NDArray[np.int64]:
    """Indices of all pictures, or of some stretches of ten seconds over a long recording.

    Example:
        >>> len(pictures_to_compare(np.arange(100) / 10)), len(pictures_to_compare(np.arange(30000) / 30))
        (100, 2400)
    """
    count = len(times_s)
    if count <= most:
        return np.arange(count)
    rate = count / max(float(times_s[-1] - times_s[0]), 1e-6)
    each = max(30, min(int(WINDOW_S * rate), most // WINDOWS))
    starts = np.linspace(0, count - each, WINDOWS).astype(np.int64)
    return np.unique(np.concatenate([np.arange(start, start + each) for start in starts]))


def _seen(recording: Recording, indices: Sequence[int] | NDArray[np.int64]) -> Floats:
    """Turns (n - 1, 3) between neighbours of the list, NaN where one cannot be read."""
    camera = small_camera(recording.calibrated)
    turns = np.full((len(indices) - 1, 3), np.nan)
    before: Floats | None = None
    for place, index in enumerate(indices):
        follows = place > 0 and index == indices[place - 1] + 1
        try:
            now = small_grey(recording.read(int(index), with_truth=False).image, camera)
        except FrameError:
            before = None
            continue
        if before is not None and follows:
            turns[place - 1] = seen_turn(camera, before, now)
        before = now
    return turns
