"""What of a stream can be learned from: a wrong label does harm for as long as it is remembered."""

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, fits_camera, has_attitude
from horizon_dl.geometry.camera import Camera
from horizon_dl.inspection.image_motion import Sketch, contradicts, same_picture, sketch_of, turn_rad
from horizon_dl.training.checkpoint import Snapshot

MOST_TURN_RAD_S = 15.0
"""Faster than this no robot with a camera turns; racing drones reach about that."""
LATE_S = 0.1
"""An attitude that is older than this belongs to another frame."""
MEMORY_S = 0.5
"""For so long a frame is compared with the last one that was believed, then with the one before it."""
DARK_LEVEL, BRIGHT_LEVEL = 8, 247
MOST_UNUSABLE = 0.9
"""With more than this share of its pixels near black or near white a frame shows nothing."""
LEAST_CONTRAST = 1.5
"""Standard deviation, grey levels, below which a sketch is one flat colour: a covered lens, a lost signal."""
FROZEN_TURN_RAD = math.radians(0.3)
"""A picture that stays although the camera turned by this much is frozen."""
COMPARED_TURN_RAD = math.radians(4.0)
"""A smaller turn is hardly seen in a sketch."""


class Distrust(StrEnum):
    """Why a frame is not learned from."""

    UNREADABLE = "unreadable"
    SIZE = "resolution changed"
    NO_ATTITUDE = "no attitude"
    LATE = "attitude late"
    CLOCK = "clock not advancing"
    DARK = "black"
    BRIGHT = "overexposed"
    FLAT = "no contrast"
    FROZEN = "image frozen"
    JUMP = "attitude jumped"

    @property
    def spoils_horizon(self) -> bool:
        """Whether the horizon of the frame is not to be believed, so that it cannot be scored either."""
        return self not in (Distrust.DARK, Distrust.BRIGHT, Distrust.FLAT)


@dataclass(frozen=True)
class _Seen:
    """What is kept of an earlier frame: its time, its sketch, and its attitude (None: not known)."""

    time_s: float
    sketch: Sketch
    up_cam: NDArray[np.float64] | None


class StreamGuard:
    """Looks at every frame of a stream, in its order, and says which may be learned from.

    Example:
        >>> guard = StreamGuard()                       # doctest: +SKIP
        >>> guard.check(frame) is None                  # doctest: +SKIP
        True
    """

    def __init__(self) -> None:
        self._before: _Seen | None = None
        self._believed: _Seen | None = None
        self._still_up: NDArray[np.float64] | None = None

    def check(self, frame: Frame, attitude_age_s: float = 0.0) -> Distrust | None:
        """Why not to learn from the next frame; None: it can be trusted.

        Args:
            frame: with `up_cam` None or NaN where the attitude is not known.
            attitude_age_s: time of the frame less time of its attitude.
        """
        up_cam = None if not has_attitude(frame) else np.asarray(frame.up_cam, np.float64)
        seen = _Seen(frame.time_s, sketch_of(frame.image), up_cam)
        found = self._problem(frame, seen, attitude_age_s)
        same = self._before is not None and same_picture(self._before.sketch, seen.sketch)
        if not same or self._still_up is None:
            self._still_up = up_cam
        if found is None:
            self._believed = seen
        if found is Distrust.CLOCK:  # a clock that was set anew has to be believed from now on
            self._believed = None
        if found is not Distrust.SIZE and math.isfinite(seen.time_s):
            # A frozen picture does not belong to its attitude.
            self._before = replace(seen, up_cam=None) if found is Distrust.FROZEN else seen
        return found

    def snapshot(self) -> Snapshot:
        """What it remembers."""
        kept = {"before": self._before, "believed": self._believed}
        tensors = {name: torch.from_numpy(seen.sketch.copy()) for name, seen in kept.items() if seen}
        values: dict[str, Any] = {
            name: {"time_s": seen.time_s, "up_cam": _listed(seen.up_cam)}
            for name, seen in kept.items()
            if seen
        }
        return Snapshot(tensors, {**values, "still_up": _listed(self._still_up)})

    def restore(self, snapshot: Snapshot) -> None:
        """Remember what a snapshot holds."""
        found = {
            name: _Seen(
                snapshot.values[name]["time_s"], sketch.numpy(), _array(snapshot.values[name]["up_cam"])
            )
            for name, sketch in snapshot.tensors.items()
        }
        self._before, self._believed = found.get("before"), found.get("believed")
        self._still_up = _array(snapshot.values["still_up"])

    def _problem(self, frame: Frame, seen: _Seen, attitude_age_s: float) -> Distrust | None:
        if not fits_camera(frame):
            return Distrust.SIZE
        if not math.isfinite(seen.time_s) or (self._before and seen.time_s <= self._before.time_s):
            return Distrust.CLOCK
        if seen.up_cam is None or frame.camera is None:
            return Distrust.NO_ATTITUDE
        if not abs(attitude_age_s) <= LATE_S:
            return Distrust.LATE
        return exposure_problem(seen.sketch) or self._motion_problem(frame.calibrated, seen)

    def _motion_problem(self, camera: Camera, seen: _Seen) -> Distrust | None:
        assert seen.up_cam is not None
        before = self._before
        if before is None:
            return None
        if self._still_up is not None and same_picture(before.sketch, seen.sketch):
            return Distrust.FROZEN if turn_rad(self._still_up, seen.up_cam) > FROZEN_TURN_RAD else None
        believed = self._believed
        reference = believed if believed and seen.time_s - believed.time_s <= MEMORY_S else before
        return Distrust.JUMP if jumped(camera, reference, seen) else None


def exposure_problem(sketch: Sketch) -> Distrust | None:
    """Whether a picture shows nothing: (nearly) all black, all white, or one flat colour."""
    if np.mean(sketch < DARK_LEVEL) > MOST_UNUSABLE:
        return Distrust.DARK
    if np.mean(sketch > BRIGHT_LEVEL) > MOST_UNUSABLE:
        return Distrust.BRIGHT
    return Distrust.FLAT if float(sketch.std()) < LEAST_CONTRAST else None


def jumped(camera: Camera, before: _Seen, now: _Seen) -> bool:
    """Whether the attitude turned faster than any robot, or turned while the picture did not."""
    if before.up_cam is None or now.up_cam is None:
        return False
    turn = turn_rad(before.up_cam, now.up_cam)
    if turn > MOST_TURN_RAD_S * (now.time_s - before.time_s):
        return True
    return turn > COMPARED_TURN_RAD and contradicts(
        camera, before.sketch, now.sketch, before.up_cam, now.up_cam
    )


def _listed(vector: NDArray[np.float64] | None) -> list[float] | None:
    return None if vector is None else [float(number) for number in vector]


def _array(numbers: list[float] | None) -> NDArray[np.float64] | None:
    return None if numbers is None else np.array(numbers)
