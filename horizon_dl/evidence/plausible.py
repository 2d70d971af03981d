"""Can a height be? Within what a flight by sight has, and no jumps from one value to the next."""

import math
from dataclasses import dataclass, field

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits

SLACK_M = 0.5
"""A range finder that passes over a table jumps by about this."""
BELIEVED_AFTER_S = 1.0
"""A jump that stays for so long was a true one: the sensor had been lost meanwhile."""
FORGOTTEN_S = 2.0


@dataclass
class HeightWatch:
    """Believes heights over the floor that can be and that do not jump.

    Example:
        >>> watch = HeightWatch()
        >>> watch.good(0.0, 1.0), watch.good(0.1, 1.2), watch.good(0.2, 90.0), watch.good(0.3, 1e9)
        (True, True, False, False)
    """

    limits: EvidenceLimits = field(default_factory=lambda: LIMITS)
    _believed: tuple[float, float] | None = None
    _jumped: tuple[float, float] | None = None

    def good(self, time_s: float, height_m: float) -> bool:
        """Whether to believe the next height, m, of that time, s."""
        least_m, most_m = self.limits.height_m
        if not (math.isfinite(height_m) and least_m <= height_m <= most_m):
            self._jumped = None
            return False
        if self._believed and time_s - self._believed[0] > FORGOTTEN_S:
            self._believed = None
        if self._believed is None or self._near(self._believed, time_s, height_m):
            self._believed, self._jumped = (time_s, height_m), None
            return True
        since_s = time_s if self._jumped is None else self._jumped[0]
        steady = self._jumped is None or self._near((time_s, self._jumped[1]), time_s, height_m)
        self._jumped = (since_s if steady else time_s, height_m)
        if time_s - self._jumped[0] < BELIEVED_AFTER_S:
            return False
        self._believed, self._jumped = (time_s, height_m), None
        return True

    def _near(self, before: tuple[float, float], time_s: float, height_m: float) -> bool:
        allowed_m = SLACK_M + self.limits.climb_m_s * max(0.0, time_s - before[0])
        return abs(height_m - before[1]) <= allowed_m
