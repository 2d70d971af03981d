"""From the figures of a check to findings in words, one rule a function."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from horizon_dl.data.doubt import Doubt
from horizon_dl.evidence.self_assessment import said
from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.inspection.clock_findings import motion_finding, times_finding
from horizon_dl.inspection.finding import Finding, Level, verdict_of
from horizon_dl.inspection.orientation_findings import convention_finding, mount_finding

FEW_FRAMES, TOO_FEW_FRAMES = 50, 5
Rule = Callable[[DataCheck], Iterator[Finding]]


def with_findings(check: DataCheck, rules: "tuple[Rule, ...] | None" = None) -> DataCheck:
    """The check with its findings by some rules, else all, problems first, and its verdict."""
    found = [finding for rule in rules or RULES for finding in rule(check)]
    order = {"problem": 0, "warning": 1, "ok": 2}
    found.sort(key=lambda finding: (order[finding.level], not finding.reason))
    level, verdict = verdict_of(found)
    return replace(check, findings=tuple(found), level=level, verdict=verdict)


def percent(share: float) -> str:
    """A share as words' percentage; small ones with a digit, never 0 or 100 unless exactly so.

    Example:
        >>> percent(0.25), percent(0.004), percent(0.9996), percent(1.0)
        ('25 %', '0.4 %', '99.9 %', '100 %')
    """
    value = share * 100
    if value in (0.0, 100.0) or 10 <= value <= 99:
        return f"{value:.0f} %"
    return f"{min(max(value, 0.1), 99.9):.1f} %"


def _counts(check: DataCheck) -> Iterator[Finding]:
    usable = check.frames - (check.attitudes.missing if check.attitudes else check.frames)
    text = f"{check.frames} frames, {usable} of them with an attitude."
    if check.attitudes is None:
        yield Finding(
            "problem",
            f"None of the {check.frames} frames has an attitude.",
            "Check the log's columns, units and clock; without an attitude there is no horizon.",
            "no frame has an attitude",
        )
    elif usable < TOO_FEW_FRAMES:
        yield Finding("problem", text, "Record more.", f"only {usable} frames can be used")
    elif usable < FEW_FRAMES:
        hint = "Record a minute or more; a few hundred different images are a good start."
        yield Finding("warning", text, hint, f"there are too few frames to train well ({usable})")
    else:
        yield Finding("ok", text)


def _missing_attitudes(check: DataCheck) -> Iterator[Finding]:
    missing = check.attitudes.missing if check.attitudes else 0
    share = missing / check.frames
    if missing and share > 0.1:
        yield Finding(
            "warning",
            f"{missing} of {check.frames} frames have no attitude and are left out.",
            "Log the attitude over the whole recording, ten times a second or more, on the images' clock.",
            "most frames have no attitude" if share > 0.5 else "",
        )
    elif missing:
        text = (
            "1 frame has no attitude and is" if missing == 1 else f"{missing} frames have no attitude and are"
        )
        yield Finding("ok", f"{text} left out.")


def _unreadable(check: DataCheck) -> Iterator[Finding]:
    if not check.unreadable:
        return
    share = check.unreadable / check.sampled
    first = check.unreadable_examples[0][1]
    text = f"{check.unreadable} of {check.sampled} images looked at cannot be read: {first}."
    hint = "Mend what is named, or remove them; they are skipped and counted."
    if share > 0.5:
        yield Finding("problem", text, hint, "most images cannot be read")
    else:
        yield Finding("warning", text, hint, "many images cannot be read" if share > 0.2 else "")


def _horizon(check: DataCheck) -> Iterator[Finding]:
    if check.labels is None:
        return
    share, labels = check.labels.visible_share, check.labels
    text = f"The horizon is visible in {percent(share)} of the frames."
    hint = "Tilt the camera so that the horizon crosses the image, or check mount_rpy_deg and rotate_image."
    if share < 0.05:
        seen = "what lies below it" if labels.below > labels.above else "what lies above it"
        reason = f"the horizon is almost never in the image, only {seen}"
        yield Finding("problem", text, hint, reason)
    elif share < 0.5:
        yield Finding("warning", text, hint, "the horizon is seldom in the image")
    else:
        yield Finding("ok", text)


def _balance(check: DataCheck) -> Iterator[Finding]:
    labels = check.labels
    if labels is None:
        return
    text = (
        f"Labels: {percent(labels.above)} above, {percent(labels.below)} below, "
        f"{percent(labels.ignored)} ignored within {check.band_deg:.1f} degrees of the horizon."
    )
    rarer, name = min((labels.above, "above"), (labels.below, "below"))
    if labels.ignored > 0.4:
        reason = "the ignored band covers most of the labels"
        yield Finding("warning", text, "Make the ignored band narrower.", reason)
    elif rarer < 0.05 and labels.visible_share >= 0.05:
        hint = f"Tilt the camera {'up' if name == 'above' else 'down'} so that both sides are seen."
        yield Finding("warning", text, hint, f"almost nothing {name} the horizon is seen")
    else:
        yield Finding("ok", text)


def _attitude(check: DataCheck) -> Iterator[Finding]:
    if check.attitudes is None:
        return
    roll, pitch = check.attitudes.roll_deg, check.attitudes.pitch_deg
    text = (
        f"Camera roll {roll.p5:.1f} to {roll.p95:.1f} degrees (median {roll.p50:.1f}), "
        f"pitch {pitch.p5:.1f} to {pitch.p95:.1f} (median {pitch.p50:.1f})."
    )
    if roll.spread > 150 or pitch.spread > 100:
        hint = "Check the units (parts of a degree have to be divided first) and the order of quaternions."
        yield Finding("warning", text, hint, "the attitude covers an unlikely range")
    elif abs(roll.p50) > 45:
        hint = "The camera seems to lie on its side or upside down: check rotate_image and mount_rpy_deg."
        yield Finding("warning", text, hint, f"the camera is rolled by {roll.p50:.0f} degrees")
    else:
        yield Finding("ok", text)


def _travel(check: DataCheck) -> Iterator[Finding]:
    labels = check.labels
    if labels is None or labels.visible_share < 0.05 or check.attitudes is None:
        return
    roll, pitch = check.attitudes.roll_deg, check.attitudes.pitch_deg
    text = (
        f"The horizon moves by {percent(labels.travel)} of the image's height; "
        f"one line drawn once would label {percent(labels.fixed_line_accuracy)} of the pixels rightly"
    )
    if max(roll.spread, pitch.spread) < 1e-6:
        hint = "Check that the log holds the measured attitude and not a constant."
        yield Finding("warning", "The attitude is the same in all frames.", hint)
    elif labels.fixed_line_accuracy > 0.99:
        hint = "Record with more pitch, roll or height; leave train.crop and train.pastes as they are."
        yield Finding("warning", f"{text}, so a net can learn the row in place of the looks.", hint)
    else:
        yield Finding("ok", f"{text}.")


def _exposure(check: DataCheck) -> Iterator[Finding]:
    if check.exposure is None:
        return
    cases = (
        (check.exposure.too_dark, "too dark", "Lengthen the exposure or add light."),
        (check.exposure.overexposed, "overexposed", "Shorten the exposure."),
        (
            check.exposure.without_contrast,
            "without contrast",
            "Check the lens cap, the focus and the decoder.",
        ),
        (check.exposure.frozen, "the same as the one before", "Check the camera driver; remove the copies."),
    )
    bad = False
    for share, what, hint in cases:
        if share > 0.02:
            bad = True
            level, reason = _weight(share, what)
            yield Finding(level, f"{percent(share)} of the images are {what}.", hint, reason)
    if check.exposure.blurred > 0.2:
        bad = True
        text = f"{percent(check.exposure.blurred)} of the images are much less sharp than the rest."
        yield Finding("warning", text, "Shorten the exposure or move more slowly.")
    if not bad:
        yield Finding("ok", "Exposure and sharpness are even, no frozen images.")


def _weight(share: float, what: str) -> tuple[Level, str]:
    if share > 0.8:
        return "problem", f"almost all images are {what}"
    return "warning", f"many images are {what}" if share > 0.3 else ""


def _rays(check: DataCheck) -> Iterator[Finding]:
    if check.labels is None or check.labels.valid_rays > 0.999:
        return
    share = percent(check.labels.valid_rays)
    text = f"{share} of the pixels have a valid ray; the lens model cannot be inverted elsewhere."
    if check.labels.valid_rays < 0.7:
        hint = "Check distortion, its order (k1, k2, p1, p2, k3) and the model in the camera file."
        yield Finding("warning", text, hint, "the lens model holds for a part of the image only")
    else:
        yield Finding("ok", text)


def _height(check: DataCheck) -> Iterator[Finding]:
    if check.height_m is None:
        yield Finding("ok", "No height over the floor: obstacles are found, but no distances in metres.")
    else:
        yield Finding("ok", f"Height over the floor {check.height_m.p5:.2f} to {check.height_m.p95:.2f} m.")


def _truth(check: DataCheck) -> Iterator[Finding]:
    truth = check.truth
    if truth is None:
        yield Finding("ok", "No truth labels: nothing to score with, learning does not need any.")
        return
    text = (
        f"{truth.labelled_frames} frames have truth labels: {percent(truth.floor)} floor, "
        f"{percent(truth.obstacle)} obstacle, {percent(truth.above)} ceiling or sky."
    )
    yield Finding("ok", text)
    if truth.floor_above_horizon > 0.02:
        yield Finding(
            "warning",
            f"{percent(truth.floor_above_horizon)} of the labelled floor lies above the horizon.",
            "A flat floor cannot: check attitude, mount_rpy_deg and the focal length; see calibrate-mount.",
            "the horizon lies too low on the labelled floor" if truth.floor_above_horizon > 0.1 else "",
        )


def _notes(check: DataCheck) -> Iterator[Finding]:
    for note in check.notes:
        level: Level = "warning" if isinstance(note, Doubt) else "ok"
        yield Finding(level, f"{note[:1].upper()}{note[1:].rstrip('.')}.")


def _quick_net(check: DataCheck) -> Iterator[Finding]:
    """What the net of `check-data --quick-train` says of itself."""
    if check.self_assessment is None:
        return
    doubt = said(check.self_assessment)
    if doubt is None:
        contradicted = percent(check.self_assessment["contradicted"])
        yield Finding(
            "ok",
            f"A quickly trained net says of itself: ok here; the net of the simulated worlds contradicts "
            f"{contradicted} of the ground. What neither knows, such as planting, shows in neither.",
        )
        return
    grave = check.self_assessment["verdict"] == "not to be trusted"
    hint = "Try `compare` on frames with truth before you rely on it; low obstacles are the usual reason."
    reason = "what a quickly trained net learns here is not to be trusted" if grave else ""
    yield Finding("warning", f"A quickly trained net says of itself: {doubt}.", hint, reason)


RULES: tuple[Rule, ...] = (
    _counts,
    _missing_attitudes,
    _unreadable,
    _horizon,
    _balance,
    _attitude,
    _travel,
    convention_finding,
    mount_finding,
    motion_finding,
    times_finding,
    _exposure,
    _rays,
    _height,
    _truth,
    _quick_net,
    _notes,
)
NOT_QUICK = (convention_finding, mount_finding, motion_finding, _height, _truth, _notes)
"""Those that need pairs of images, or tell nothing of whether data can be learned from."""
QUICK_RULES = tuple(rule for rule in RULES if rule not in NOT_QUICK)
