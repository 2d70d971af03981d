"""Frozen pictures and jumping attitudes: what only shows from one frame to the next."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.motion import contradicts, turn_rad
from horizon_dl.evidence.reason import Reason
from horizon_dl.evidence.sketch import Sketch, same_picture
from horizon_dl.geometry.camera import Camera


@dataclass(frozen=True)
class Seen:
    """What is kept of an earlier frame: its time, s, its sketch, and its attitude (None: not known)."""

    time_s: float
    sketch: Sketch
    up_cam: NDArray[np.float64] | None


@dataclass
class MotionWatch:
    """Compares each frame with the last one that was believed, or with the one before it.

    Attributes:
        limits: see there.
        before: the frame before.
        believed: the last one that was believed.
        still_up: the attitude, (3,) `up_cam`, at which the picture was last seen to change.
        still_s: and the time of that, s.
    """

    limits: EvidenceLimits = field(default_factory=lambda: LIMITS)
    before: Seen | None = None
    believed: Seen | None = None
    still_up: NDArray[np.float64] | None = None
    still_s: float = math.inf

    def problem(self, camera: Camera, seen: Seen) -> Reason | None:
        """`FROZEN`, `ATTITUDE` or None; nothing is remembered yet."""
        if self.before is None or seen.up_cam is None:
            return None
        if self.still_up is not None and same_picture(self.before.sketch, seen.sketch):
            turned = turn_rad(self.still_up, seen.up_cam) > self.limits.frozen_turn_rad
            return Reason.FROZEN if turned else None
        known = self.believed and seen.time_s - self.believed.time_s <= self.limits.memory_s
        reference = self.believed if known and self.believed else self.before
        return Reason.ATTITUDE if self._jumped(camera, reference, seen) else None

    def is_still(self, seen: Seen) -> bool:
        """Whether the picture is the same one as before."""
        return self.before is not None and same_picture(self.before.sketch, seen.sketch)

    def remember(self, seen: Seen, *, believed: bool, frozen: bool) -> None:
        """Take a frame for the last one.

        Args:
            seen: the frame.
            believed: it may be compared with.
            frozen: its picture does not belong to its attitude.
        """
        if not self.is_still(seen) or self.still_up is None:
            self.still_up, self.still_s = seen.up_cam, seen.time_s
        if believed:
            self.believed = seen
        self.before = replace(seen, up_cam=None) if frozen else seen

    def _jumped(self, camera: Camera, before: Seen, now: Seen) -> bool:
        """Whether the attitude turned faster than any robot, or turned while the picture did not."""
        if before.up_cam is None or now.up_cam is None:
            return False
        turn = turn_rad(before.up_cam, now.up_cam)
        if turn > self.limits.turn_rad_s * (now.time_s - before.time_s):
            return True
        return turn > self.limits.compared_turn_rad and contradicts(
            camera, before.sketch, now.sketch, before.up_cam, now.up_cam
        )
