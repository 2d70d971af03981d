"""What of a stream can be learned from: a wrong label does harm for as long as it is remembered."""

import math
from enum import StrEnum
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, fits_camera, has_attitude
from horizon_dl.evidence.exposure import exposure_problem
from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.reason import Reason
from horizon_dl.evidence.sketch import sketch_of
from horizon_dl.evidence.stream import MotionWatch, Seen
from horizon_dl.training.checkpoint import Snapshot


class Distrust(StrEnum):
    """Why a frame is not learned from."""

    UNREADABLE = "unreadable"
    SIZE = "resolution changed"
    NO_ATTITUDE = "no attitude"
    CLOCK = "clock not advancing"
    DARK = Reason.DARK.value
    BRIGHT = Reason.BRIGHT.value
    FLAT = Reason.FLAT.value
    FROZEN = Reason.FROZEN.value
    JUMP = Reason.ATTITUDE.value

    @property
    def spoils_horizon(self) -> bool:
        """Whether the horizon of the frame is not to be believed, so that it cannot be scored either."""
        return self not in (Distrust.DARK, Distrust.BRIGHT, Distrust.FLAT)


class StreamGuard:
    """Looks at every frame of a stream, in its order, and says which may be learned from.

    Example:
        >>> guard = StreamGuard()                       # doctest: +SKIP
        >>> guard.check(frame) is None                  # doctest: +SKIP
        True
    """

    def __init__(self, limits: EvidenceLimits = LIMITS) -> None:
        self._limits, self._motion = limits, MotionWatch(limits)

    def check(self, frame: Frame) -> Distrust | None:
        """Why not to learn from the next frame; None: it can be trusted.

        Args:
            frame: with `up_cam` None or NaN where the attitude is not known.
        """
        up_cam = None if not has_attitude(frame) else np.asarray(frame.up_cam, np.float64)
        seen = Seen(frame.time_s, sketch_of(frame.image), up_cam)
        found = self._problem(frame, seen)
        if found is not Distrust.SIZE and math.isfinite(seen.time_s):
            self._motion.remember(seen, believed=found is None, frozen=found is Distrust.FROZEN)
        if found is Distrust.CLOCK:  # a clock that was set anew has to be believed from now on
            self._motion.believed = None
        return found

    def snapshot(self) -> Snapshot:
        """What it remembers."""
        kept = {"before": self._motion.before, "believed": self._motion.believed}
        tensors = {name: torch.from_numpy(seen.sketch.copy()) for name, seen in kept.items() if seen}
        values: dict[str, Any] = {
            name: {"time_s": seen.time_s, "up_cam": _listed(seen.up_cam)}
            for name, seen in kept.items()
            if seen
        }
        return Snapshot(tensors, {**values, "still_up": _listed(self._motion.still_up)})

    def restore(self, snapshot: Snapshot) -> None:
        """Remember what a snapshot holds."""
        found = {
            name: Seen(
                snapshot.values[name]["time_s"], sketch.numpy(), _array(snapshot.values[name]["up_cam"])
            )
            for name, sketch in snapshot.tensors.items()
        }
        self._motion.before, self._motion.believed = found.get("before"), found.get("believed")
        self._motion.still_up = _array(snapshot.values["still_up"])

    def _problem(self, frame: Frame, seen: Seen) -> Distrust | None:
        before = self._motion.before
        if not fits_camera(frame):
            return Distrust.SIZE
        if not math.isfinite(seen.time_s) or (before and seen.time_s <= before.time_s):
            return Distrust.CLOCK
        if seen.up_cam is None or frame.camera is None:
            return Distrust.NO_ATTITUDE
        reason = exposure_problem(seen.sketch, self._limits) or self._motion.problem(frame.calibrated, seen)
        return None if reason is None else Distrust(reason.value)


def _listed(vector: NDArray[np.float64] | None) -> list[float] | None:
    return None if vector is None else [float(number) for number in vector]


def _array(numbers: list[float] | None) -> NDArray[np.float64] | None:
    return None if numbers is None else np.array(numbers)
