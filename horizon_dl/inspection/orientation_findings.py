"""From what the pictures say of convention and mount to findings in words."""

import math
from collections.abc import Iterator

from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.inspection.finding import Finding

WORTH_A_FINDING_RAD = math.radians(1.0)
"""A mount error that the ignored band does not cover well."""


def convention_finding(check: DataCheck) -> Iterator[Finding]:
    """Whether the attitude is read as the pictures turn."""
    found = check.orientation
    if found is None or not found.pairs:
        return
    text = " ".join(found.lines()[:1])
    if found.option:
        hint = f'Read it so with --convention "{found.option}", or correct the log.'
        yield Finding("warning", text, hint, f"the attitude is read wrongly: {found.says}")
    else:
        yield Finding("ok", text)


def mount_finding(check: DataCheck) -> Iterator[Finding]:
    """Whether upright edges stand upright under the stated mount."""
    mount = None if check.orientation is None else check.orientation.mount
    if mount is None:
        return
    angles = {"roll": mount.fit.roll, "pitch": mount.fit.pitch}
    off = [
        f"{name} {math.degrees(one.correction):+.1f}"
        for name, one in angles.items()
        if mount.is_worth(one, WORTH_A_FINDING_RAD)
    ]
    if not off:
        yield Finding("ok", "Upright edges stand upright: nothing speaks against the stated mount.")
        return
    yield Finding(
        "warning",
        f"By upright edges the camera is mounted otherwise than stated: {' and '.join(off)} degrees "
        "about its own axes.",
        f"See calibrate-mount; if the calibration of the lens is right, {mount.way_out}.",
    )
