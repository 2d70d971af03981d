"""Puts a recording on the clock that its pictures tell, where they tell it surely."""

from dataclasses import replace

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.logs.clock.clock_fit import ClockFit
from horizon_dl.logs.clock.find_clock import find_clock
from horizon_dl.logs.log_recording import describe_ranges


def on_found_clock(recording: Recording) -> Recording:
    """The recording with its log on the frames' clock as the pictures show it, and a note that says so.

    Raises:
        InputError: it has no log, or the pictures do not tell the offset within half a frame.
    """
    log = recording.attitudes
    if log is None:
        raise InputError(
            "--time-offset auto", "needs a log", "give one with --attitude, or leave the option out"
        )
    fit = find_clock(recording)
    if fit is None or not fit.sure:
        why = "pictures and log turn too little together" if fit is None else f"only {describe(fit)}"
        raise InputError(
            recording.name, f"does not tell the offset of its log: {why}", "give --time-offset=SECONDS"
        )
    moved = log.on_clock(fit.offset_s, fit.drift_ppm)
    mount = recording.mount_rpy_rad or (0.0, 0.0, 0.0)
    headers = [_with(header, moved.header(header.name, header.time_s, mount)) for header in recording.headers]
    ranges = f"Clocks: {describe_ranges([header.time_s for header in headers], moved)}."
    note = f"Clock found from the pictures: {option(fit)} ({describe(fit)})."
    return replace(recording, headers=headers, attitudes=moved, notes=(ranges, *recording.notes, note))


def _with(header: FrameHeader, known: FrameHeader) -> FrameHeader:
    return replace(
        header, up_cam=known.up_cam, yaw_rad=known.yaw_rad, height_m=known.height_m, as_read=known.as_read
    )


def option(fit: ClockFit) -> str:
    """The fit as an option of the command line.

    Example:
        >>> option(ClockFit(-0.25, 120.0, 0.004, 10.0, 0.8, 0.4, 0.033, 900))
        '--time-offset=-0.250,120'
    """
    return f"--time-offset={fit.offset_s:.3f}" + (f",{fit.drift_ppm:.0f}" if fit.drift_ppm else "")


def describe(fit: ClockFit) -> str:
    """Its doubt in words."""
    drift = (
        "" if fit.drift_doubt_ppm is None else f", drift {fit.drift_ppm:.0f} +- {fit.drift_doubt_ppm:.0f} ppm"
    )
    return (
        f"{fit.offset_s:.3f} +- {fit.doubt_s:.3f} s{drift}, correlation {fit.correlation:.2f}, "
        f"{fit.lead:.2f} over the next best"
    )
