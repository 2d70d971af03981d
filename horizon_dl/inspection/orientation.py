"""By which convention the attitude is to be read and how the camera is mounted, told by the pictures."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from horizon_dl.data.convention import convention_in_words
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.axes import ALL_AXES, axes_in_words
from horizon_dl.inspection.conventions import BETTER, ConventionFit, Fit, fit_conventions, fit_ups, motion_of
from horizon_dl.inspection.mount_check import MountCheck, check_mount
from horizon_dl.inspection.turns import measure_turns

USUAL = ("flu", "frd", "rdf")


@dataclass(frozen=True)
class Orientation:
    """What the pictures say of the attitude.

    Attributes:
        option: words for `--convention`; empty where the attitude is read rightly, or nothing is told.
        says: the same for people.
        told: the pictures turn enough to tell.
        miss_deg: mean angle by which up misses where the turns carry it, under the best reading.
        stated_miss_deg: under the stated one.
        motion_deg: mean angle that the turns move it by.
        pairs: of pictures compared.
        mount: the mount under the best reading; None where the edges do not tell.
    """

    option: str
    says: str
    told: bool
    miss_deg: float
    stated_miss_deg: float
    motion_deg: float
    pairs: int
    mount: MountCheck | None = None

    def lines(self) -> list[str]:
        """For the console."""
        if not self.told:
            return [
                "The pictures turn too little to tell by which convention the attitude is to be read: in the "
                f"liveliest {self.pairs} pairs up moves by {self.motion_deg:.2f} degrees, and is told to "
                f"{self.miss_deg:.2f}. Some seconds of turns of 5 degrees and more about two axes would tell."
            ]
        miss = f"misses {self.miss_deg:.2f} degrees"
        if not self.option:
            return [f"The attitude is read as the pictures turn ({miss} of {self.motion_deg:.2f})."]
        return [
            f"The pictures turn otherwise than the attitude as it is read: {self.says} "
            f"({miss} in place of {self.stated_miss_deg:.2f}).",
            f'To read it so: --convention "{self.option}"',
        ]


def check_convention(recording: Recording, *, progress: bool = False) -> Orientation | None:
    """Which convention agrees with the pictures; None where its numbers are not kept or too few pictures."""
    if recording.reading is None:
        return None
    turns = measure_turns(recording, progress=progress)
    as_read = [header.as_read for header in recording.headers]
    fit = fit_conventions(turns, as_read, recording.reading)
    if fit is None:
        return None
    quaternions = any(one is not None and len(one) == 4 for one in as_read)
    stated, best = fit.stated.convention, fit.best.convention
    return Orientation(
        " ".join(best.differences(stated, quaternions)) if fit.sure else "",
        _in_words(fit, quaternions),
        fit.told,
        math.degrees(fit.best.miss_rad),
        math.degrees(fit.stated.miss_rad),
        math.degrees(fit.motion_rad),
        fit.pairs,
    )


def _in_words(fit: ConventionFit, quaternions: bool) -> str:
    if not fit.sure:
        return ""
    says = convention_in_words(fit.best.convention, fit.stated.convention, quaternions)
    return f"{says}, or the images are stored on their side (rotate_image)" if fit.turned else says


def check_orientation(recording: Recording, *, progress: bool = False) -> Orientation | None:
    """The convention, and the mount under it; None where neither is told."""
    found = check_convention(recording, progress=progress)
    try:
        right = recording.read_as(found.option) if found and found.option else recording
        mount = check_mount(right, progress=progress)
    except InputError:
        return found
    if found is None:
        return Orientation("", "", False, 0.0, 0.0, 0.0, 0, mount)
    return Orientation(**{**vars(found), "mount": mount})


def find_imu_axes(open_with: Callable[[str], Recording], *, progress: bool = False) -> str | None:
    """The axes of an IMU under which the pictures agree with the attitude; None where they do not tell.

    Args:
        open_with: opens the recording with the named axes.
        progress: show a bar.
    """
    turns = measure_turns(open_with(ALL_AXES[0]), progress=progress)
    fits: list[tuple[str, Fit, float]] = []
    for axes in ALL_AXES:
        headers = open_with(axes).headers
        ups = np.array([np.full(3, np.nan) if one.up_cam is None else one.up_cam for one in headers])
        fit = fit_ups(turns, ups)
        if fit is not None:
            fits.append((axes, fit, motion_of(turns, ups)))
    fits.sort(key=lambda row: row[1].miss_rad)
    if not fits or fits[0][1].miss_rad > BETTER * fits[0][2]:
        return None
    near = [row[0] for row in fits if row[1].miss_rad <= fits[0][1].miss_rad / BETTER]
    usual = [axes for axes in near if axes in USUAL]
    return near[0] if len(near) == 1 else usual[0] if len(usual) == 1 else None


def axes_line(axes: str) -> str:
    """What was found of an IMU's axes, for the console."""
    meaning = axes_in_words(axes)
    return f"The pictures say that the IMU has {meaning}; write into the calibration file: 'imu_axes: {axes}'"
