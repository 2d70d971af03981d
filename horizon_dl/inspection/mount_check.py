"""A recording's mount error, and what it means in words."""

import math
from dataclasses import dataclass
from typing import Any

from horizon_dl.data.evenly import evenly
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.lines import LinePlanes, line_planes
from horizon_dl.inspection.mount import AGREES_RAD, Angle, MountFit, corrected_mount, fit_mount
from horizon_dl.progress import show_progress

MOST_FRAMES = 80
SURE_RAD = math.radians(0.5)
"""With a standard deviation over this an angle cannot be told."""
WORTH_RAD = math.radians(0.5)

Mount = tuple[float, float, float]
NO_MOUNT: Mount = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class MountCheck:
    """The fit and the mount it is a correction of.

    Attributes:
        name: of the recording.
        stated_rpy_rad: the mount that the attitudes were used with; None where no file states one.
        fit: of the images.
    """

    name: str
    stated_rpy_rad: Mount | None
    fit: MountFit

    @property
    def corrected_rpy_deg(self) -> list[float]:
        """The mount with those corrections that are sure and worth it, to a tenth of a degree."""
        roll, pitch = (one.correction if _is_off(one) else 0.0 for one in (self.fit.roll, self.fit.pitch))
        right = corrected_mount(self.stated_rpy_rad or NO_MOUNT, roll, pitch)
        return [round(math.degrees(angle), 1) + 0.0 for angle in right]

    def is_worth(self, angle: Angle, least_rad: float) -> bool:
        """Whether an angle is surely off by at least this much."""
        return _is_off(angle) and abs(angle.correction) >= least_rad

    @property
    def way_out(self) -> str:
        """What to do about the corrections."""
        if self.stated_rpy_rad is None:
            return "no file states a mount: turn the camera by them in its own calibration"
        return f"write mount_rpy_deg: [{', '.join(f'{angle:g}' for angle in self.corrected_rpy_deg)}]"

    @property
    def is_off(self) -> bool:
        """Whether the images speak against the stated mount."""
        return _is_off(self.fit.roll) or _is_off(self.fit.pitch)

    @property
    def level_agrees(self) -> bool:
        """Whether the level edges, by themselves, say the same of the pitch."""
        level = self.fit.level_pitch
        return level is not None and abs(level - self.fit.pitch.correction) <= AGREES_RAD

    def to_json(self) -> dict[str, Any]:
        """Angles in degrees."""
        fit = self.fit
        return {
            "data": self.name,
            "frames": fit.frames,
            "edges": fit.edges,
            "stated_rpy_deg": [math.degrees(angle) for angle in self.stated_rpy_rad or NO_MOUNT],
            "roll": _in_degrees(fit.roll),
            "pitch": _in_degrees(fit.pitch),
            "level_pitch_deg": None if fit.level_pitch is None else math.degrees(fit.level_pitch),
            "level_agrees": self.level_agrees,
            "is_off": self.is_off,
            "mount_rpy_deg": self.corrected_rpy_deg,
        }


def check_mount(recording: Recording, *, progress: bool = False) -> MountCheck:
    """Looks at up to 80 frames, evenly spread.

    Args:
        recording: with attitudes.
        progress: show a bar.

    Raises:
        InputError: the images do not tell.
    """
    usable = [index for index, entry in enumerate(recording.headers) if entry.up_cam is not None]
    chosen = evenly(usable, MOST_FRAMES)
    planes: list[LinePlanes] = []
    ups: list[Any] = []
    for index in show_progress(chosen, "looking for edges", unit="image", disable=not progress):
        try:
            frame = recording.read(index)
        except FrameError:
            continue
        planes.append(line_planes(frame.image, frame.calibrated))
        ups.append(frame.up_cam)
    fit = fit_mount(planes, ups)
    if fit is None or not (is_sure(fit.roll) or is_sure(fit.pitch)):
        raise InputError(
            recording.name,
            "its images do not tell how the camera is mounted: too few upright edges, or they disagree",
            "record walls, doors or posts on both sides of the view, or measure the mount",
        )
    return MountCheck(recording.name, recording.mount_rpy_rad, fit)


def is_sure(angle: Angle) -> bool:
    """Whether the images tell this angle."""
    return angle.sd <= SURE_RAD and not angle.at_limit


def mount_lines(check: MountCheck) -> list[str]:
    """The check for the console."""
    fit = check.fit
    lines = [f"{check.name}: {fit.edges} straight edges in {fit.frames} frames"]
    lines += [_said("roll", fit.roll), f"{_said('pitch', fit.pitch)}; {_level_said(check)}"]
    if not check.is_off:
        return [*lines, "Nothing speaks against the stated mount."]
    return [*lines, f"The mount is off. To correct it, {check.way_out}"]


def _said(name: str, angle: Angle) -> str:
    if not is_sure(angle):
        return f"{name:<6} cannot be told"
    degrees, sd = math.degrees(angle.correction), math.degrees(angle.sd)
    return f"{name:<6} {degrees:+.1f} degrees (sd {sd:.1f}) about the camera's own axes, by upright edges"


def _level_said(check: MountCheck) -> str:
    if check.fit.level_pitch is None:
        return "level edges say nothing"
    says = f"{math.degrees(check.fit.level_pitch):+.1f}"
    return f"level edges agree, {says}" if check.level_agrees else f"level edges do not agree, {says}"


def _is_off(angle: Angle) -> bool:
    return is_sure(angle) and abs(angle.correction) > max(2 * angle.sd, WORTH_RAD)


def _in_degrees(angle: Angle) -> dict[str, Any]:
    return {
        "correction_deg": math.degrees(angle.correction),
        "sd_deg": math.degrees(angle.sd),
        "sure": is_sure(angle),
    }
