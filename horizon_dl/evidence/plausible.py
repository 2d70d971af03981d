"""Can a height be? Within what a flight by sight has, and no jumps from one value to the next."""

import math
from dataclasses import dataclass, field

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits

SLACK_M = 0.5
"""A range finder that passes over a table jumps by about this."""
BELIEVED_AFTER_S = 1.0
"""A jump that stays for so long was a true one: the sensor had been lost meanwhile."""
FORGOTTEN_S = 2.0
"""After so long without any height that can be, the next one is believed."""


@dataclass
class HeightWatch:
    """Believes heights over the floor that can be and that do not jump.

    A height that could have been climbed to since the last believed one is no jump; no more is allowed while
    heights come that are doubted.

    Example:
        >>> watch = HeightWatch()
        >>> watch.good(0.0, 1.0), watch.good(0.1, 1.2), watch.good(0.2, 90.0), watch.good(0.3, 1e9)
        (True, True, False, False)
    """

    limits: EvidenceLimits = field(default_factory=lambda: LIMITS)
    _believed: tuple[float, float] | None = None
    _newest_s: float | None = None
    _doubted_s: float | None = None
    _steady: tuple[float, float] | None = None

    def good(self, time_s: float, height_m: float) -> bool:
        """Whether to believe the next height, m, of that time, s."""
        least_m, most_m = self.limits.height_m
        if not (math.isfinite(height_m) and least_m <= height_m <= most_m):
            self._steady = None
            return False
        if self._newest_s is not None and time_s - self._newest_s > FORGOTTEN_S:
            self._believed = None
        self._newest_s = time_s
        doubted_s = time_s if self._doubted_s is None else self._doubted_s
        if self._believed is None or self._near(self._believed, doubted_s, height_m):
            return self._believe(time_s, height_m)
        stays = self._steady is not None and self._near((time_s, self._steady[1]), time_s, height_m)
        since_s = self._steady[0] if self._steady is not None and stays else time_s
        if time_s - since_s >= BELIEVED_AFTER_S:
            return self._believe(time_s, height_m)
        self._steady, self._doubted_s = (since_s, height_m), doubted_s
        return False

    def _believe(self, time_s: float, height_m: float) -> bool:
        self._believed, self._steady, self._doubted_s = (time_s, height_m), None, None
        return True

    def _near(self, before: tuple[float, float], time_s: float, height_m: float) -> bool:
        allowed_m = SLACK_M + self.limits.climb_m_s * max(0.0, time_s - before[0])
        return abs(height_m - before[1]) <= allowed_m
