"""From the times of a recording, and from how its pictures turn, to findings in words."""

from collections.abc import Iterator

from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.inspection.finding import Finding
from horizon_dl.inspection.time_offset import MotionFit
from horizon_dl.logs.clock.align import describe, option
from horizon_dl.logs.clock.clock_fit import ClockFit


def times_finding(check: DataCheck) -> Iterator[Finding]:
    """Length and rate, gaps, and a clock that runs backwards or stands."""
    times = check.timing
    rate = "" if times.rate_hz is None else f", usually {times.rate_hz:.3g} a second"
    yield Finding("ok", f"{times.duration_s:.1f} s{rate}.")
    if times.gaps:
        text = (
            f"{times.gaps} time gap{'s' if times.gaps > 1 else ''}, the longest of "
            f"{times.longest_gap_s:.1f} s after {times.longest_gap_after}."
        )
        yield Finding(
            "warning", text, "Dropped frames do no harm to training; the attitude must not be bridged."
        )
    if times.backwards:
        text = f"The clock runs backwards {_times_in_words(times.backwards)}."
        yield Finding("warning", text, "Split the recording where the clock was set, or correct time_s.")
    if times.repeated:
        doubled = "1 frame has" if times.repeated == 1 else f"{times.repeated} frames have"
        text = f"{doubled} the same time as the frame before."
        yield Finding("warning", text, "Store times with more digits, or remove doubled frames.")


def _times_in_words(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def motion_finding(check: DataCheck) -> Iterator[Finding]:
    """Whether the pictures turn as the attitude does, and at the same time."""
    fit = check.motion
    if fit is None:
        return
    opposed = min(fit.pitch or 0.0, fit.roll or 0.0)
    # Swaying back and forth opposes itself half a period later, so the stronger explanation is told.
    if opposed <= -0.35 and -opposed > fit.best_correlation:
        angle = "pitch" if opposed == fit.pitch else "roll"
        yield Finding(
            "warning",
            f"The images move against the attitude's {angle} (correlation {opposed:.2f}).",
            "Check the signs (pitch: nose up, roll: right side down), rotate_image and mount_rpy_deg.",
            f"the images move against the attitude's {angle}",
        )
    elif check.clock is not None and check.clock.sure:
        yield from _clock(check.clock)
    elif fit.best_correlation >= 0.45 and fit.best_correlation - fit.correlation >= 0.25 and fit.best_lag_s:
        yield _apart(fit)
    elif fit.correlation >= 0.3:
        yield Finding("ok", f"The images move as the attitude says (correlation {fit.correlation:.2f}).")
    elif abs(fit.correlation) < 0.15 and fit.pairs >= 50:
        text = f"The images do not move as the attitude says (correlation {fit.correlation:.2f})."
        yield Finding("warning", text, "Check that the log belongs to these images, its clock and its units.")


def _clock(fit: ClockFit) -> Iterator[Finding]:
    """The offset that the pictures tell surely."""
    if abs(fit.offset_s) < fit.frame_s / 2 and abs(fit.drift_ppm) < 200:
        yield Finding("ok", f"The images turn as the log says, at the same time: {describe(fit)}.")
    else:
        yield Finding(
            "warning",
            f"The log is on another clock than the images: {describe(fit)}.",
            f"Give {option(fit)} on top of the offset in use.",
            "images and attitude do not belong to the same time",
        )


def _apart(fit: MotionFit) -> Finding:
    seconds = f"{abs(fit.best_lag_s):.2f} s"
    when, change = (
        ("later", f"add {seconds} to") if fit.best_lag_s > 0 else ("earlier", f"take {seconds} from")
    )
    return Finding(
        "warning",
        f"The images move as the attitude of {seconds} {when} says "
        f"(correlation {fit.best_correlation:.2f} in place of {fit.correlation:.2f}).",
        f"The clocks seem apart: {change} the images' times.",
        "images and attitude do not belong to the same time",
    )
