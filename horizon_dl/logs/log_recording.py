"""Frames with times of their own meet a log of attitudes: the two clocks, and what is said about them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from horizon_dl.calibration.calibration import Calibration
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import MAX_GAP_S

LEAST_UNIX_S = 5e8
"""Larger times, s, count from 1970."""
SLOW = 0.75
"""From this share of the longest gap that is bridged on, jitter loses frames."""
OVERLAP_SHARE = 0.5
"""Under this share of the frames inside the log, the ranges are a warning."""


def headers_by_log(
    where: Path,
    names: Sequence[str],
    times_s: Sequence[float],
    calibration: Calibration | None,
    log: AttitudeLog | ConstantAttitude | None,
    given: Given,
) -> tuple[list[FrameHeader], AttitudeLog | None, tuple[str, ...]]:
    """Headers of frames, the log on the frames' clock, and notes: both ranges first.

    Args:
        where: the film or folder.
        names: of the frames.
        times_s: of the frames, s, on their own clock.
        calibration: of the camera; None: no attitude can be told.
        log: on its clock.
        given: offset and drift between the clocks.

    Raises:
        InputError: an attitude is needed, and frames and log never meet; both ranges and a hint are named.
    """
    pairs = zip(names, times_s, strict=True)
    if log is None or calibration is None:
        return [FrameHeader(name, time_s) for name, time_s in pairs], None, ()
    mount = calibration.mount_rpy_rad
    if isinstance(log, ConstantAttitude):
        return [log.header(name, time_s, mount) for name, time_s in pairs], None, ()
    log = _since_1970(log, times_s)
    moved = log.on_clock(given.time_offset_s, given.time_drift_ppm)
    ranges = describe_ranges(times_s, moved)
    inside = sum(moved.times_s[0] <= time_s <= moved.times_s[-1] for time_s in times_s)
    if not inside and given.needs_attitude and not given.find_offset:
        raise InputError(where, f"and its log never meet: {ranges}", suggestion(times_s, log))
    headers = [moved.header(name, time_s, mount) for name, time_s in pairs]
    if given.find_offset:  # what is told of this clock would not hold for the one that is found
        return headers, moved, log.notes
    few = (
        ()
        if inside >= OVERLAP_SHARE * len(names)
        else (Doubt(f"Only {inside} of {len(names)} frames lie inside the log; {suggestion(times_s, log)}."),)
    )
    return headers, moved, (f"Clocks: {ranges}.", *few, *_slow(log), *log.notes)


def _slow(log: AttitudeLog) -> tuple[Doubt, ...]:
    """What is said of a log whose usual step nears the longest that is bridged."""
    steps_s = np.diff(log.times_s)
    step_s = float(np.median(steps_s[steps_s > 0.0])) if (steps_s > 0.0).any() else 0.0
    if step_s < SLOW * MAX_GAP_S:
        return ()
    says = f"The log has an attitude every {step_s:.2f} s, and gaps over {MAX_GAP_S:g} s are not bridged"
    return (Doubt(f"{says}: frames between are left out. Log ten times a second or more."),)


def _since_1970(log: AttitudeLog, times_s: Sequence[float]) -> AttitudeLog:
    """The log by the time that its GPS told, where the frames count from 1970 and the log does not."""
    if log.unix_start_s is None or min(times_s) < LEAST_UNIX_S or log.times_s[0] > LEAST_UNIX_S:
        return log
    offset_s = log.unix_start_s - float(log.times_s[0])
    note = f"The log's times are put to those since 1970 by its GPS, {offset_s:+.3f} s."
    return replace(log.on_clock(offset_s), notes=(*log.notes, note))


def describe_ranges(times_s: Sequence[float], log: AttitudeLog) -> str:
    """Both time ranges in words.

    Example:
        >>> import numpy as np
        >>> describe_ranges([0.0, 2.0], AttitudeLog(np.array([1.0, 3.0]), np.eye(4)[[0, 0]]))
        'the frames are from 0.000 to 2.000 s, the log from 1.000 to 3.000 s'
    """
    return (
        f"the frames are from {min(times_s):.3f} to {max(times_s):.3f} s, "
        f"the log from {log.times_s[0]:.3f} to {log.times_s[-1]:.3f} s"
    )


def suggestion(times_s: Sequence[float], log: AttitudeLog) -> str:
    """What a user may try where the clocks are apart: a unit, a common start, or the offset to be found."""
    for factor, unit in ((1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds")):
        span = (log.times_s[-1] - log.times_s[0]) * factor
        film = max(times_s) - min(times_s)
        if film > 0 and 0.2 < span / film < 5.0:
            return f"the log's times look like {unit}: divide them by {1 / factor:.0f}"
    offset_s = min(times_s) - log.times_s[0]
    clock = " (it counts from 1970)" if log.times_s[0] > LEAST_UNIX_S else " (it counts from boot)"
    return (
        f"the log is on another clock{clock}: if both start together give --time-offset={offset_s:.3f}, "
        "or --time-offset=auto to find it from the pictures"
    )
