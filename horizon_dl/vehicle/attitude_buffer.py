"""Attitudes and heights of the last seconds, and those at an image's time."""

import math
from collections import deque

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.geometry.attitude import MAX_GAP_S, interpolate

KEPT = 400  # 4 s at 100 Hz
MAX_HEIGHT_AGE_S = 1.0
DRIFT_PER_S = 1e-3
MAX_AHEAD_S = 0.15
"""So much earlier than ever a message may seem to be sent; more is a wrong stamp, or a late start."""
AHEAD_BELIEVED = 5


class ClockOffset:
    """From a sender's clock to ours: the smallest delay seen is taken for none.

    Messages arrive late by varying amounts, never early. The offset may grow by 1 ms a second, so that two
    drifting clocks stay together. A sender that starts again (its time falls by more than a second) is
    learned anew. One stamp that is ahead of all others would shift every later attitude into the past: it is
    left out until five in a row say the same.

    Example:
        >>> clock = ClockOffset()
        >>> times = ((1.0, 11.02), (1.1, 11.1), (1.2, 11.25))
        >>> [round(clock.to_ours(sent, arrival), 2) for sent, arrival in times]
        [11.02, 11.1, 11.2]
    """

    def __init__(self) -> None:
        self._offset_s = math.inf
        self._last_s = -math.inf
        self._ahead = 0

    def to_ours(self, sender_s: float, arrival_s: float) -> float:
        """When a message was sent, by our clock; never later than its arrival; NaN: a wrong stamp."""
        if math.isfinite(self._offset_s) and arrival_s - sender_s < self._offset_s - MAX_AHEAD_S:
            self._ahead += 1
            if self._ahead < AHEAD_BELIEVED:
                return math.nan
        self._ahead = 0
        if sender_s < self._last_s - 1.0:
            self._offset_s, self._last_s = math.inf, -math.inf
        grown = self._offset_s + DRIFT_PER_S * max(0.0, min(sender_s - self._last_s, 10.0))
        self._offset_s = min(grown, arrival_s - sender_s) if math.isfinite(grown) else arrival_s - sender_s
        self._last_s = max(self._last_s, sender_s)
        return sender_s + self._offset_s


class AttitudeBuffer:
    """The newest attitudes (w, x, y, z; body FRD to world NED) and heights, by our clock."""

    def __init__(self) -> None:
        self._attitudes: deque[tuple[float, NDArray[np.float64]]] = deque(maxlen=KEPT)
        self._heights: deque[tuple[float, float]] = deque(maxlen=KEPT)
        self._changed_s = math.inf

    def add(self, time_s: float, quaternion: ArrayLike) -> bool:
        """Keep an attitude; False for what is no rotation, or not newer than the last one."""
        if not math.isfinite(time_s):
            return False
        q = np.asarray(quaternion, np.float64)
        norm = float(np.linalg.norm(q))
        if not abs(norm - 1) < 0.1 or (self._attitudes and time_s <= self._attitudes[-1][0]):
            return False
        if not self._attitudes or not np.array_equal(q / norm, self._attitudes[-1][1]):
            self._changed_s = time_s
        self._attitudes.append((time_s, q / norm))
        return True

    def add_height(self, time_s: float, height_m: float) -> None:
        """Keep a height over the floor, if it is a positive number."""
        if math.isfinite(height_m) and height_m > 0:
            self._heights.append((time_s, height_m))

    def clear(self) -> None:
        """Forget the attitudes, as when the sender has started again."""
        self._attitudes.clear()

    @property
    def newest_s(self) -> float:
        """Time of the newest attitude, -inf for none."""
        return self._attitudes[-1][0] if self._attitudes else -math.inf

    @property
    def still_s(self) -> float:
        """For how long the attitude has been the same to the last bit, s; an IMU's noise changes each."""
        return max(0.0, self.newest_s - self._changed_s) if self._attitudes else 0.0

    @property
    def rate_hz(self) -> float | None:
        """Of the attitudes kept, by the median of their gaps; None for fewer than three."""
        times = [kept_s for kept_s, _ in list(self._attitudes)]
        gap_s = float(np.median(np.diff(times))) if len(times) > 2 else 0.0
        return 1.0 / gap_s if gap_s > 0 else None

    def at(self, time_s: float, max_ahead_s: float = 0.0) -> NDArray[np.float64] | None:
        """The attitude at a time, interpolated; None outside of what is kept and in gaps of over 0.2 s.

        Args:
            time_s: of the image.
            max_ahead_s: so far after the newest attitude that one is taken as it is.
        """
        if not self._attitudes:
            return None
        newest_s, newest = self._attitudes[-1]
        if newest_s < time_s <= newest_s + max_ahead_s:
            return newest
        kept = list(self._attitudes)
        times = np.array([kept_s for kept_s, _ in kept])
        return interpolate(times, np.stack([q for _, q in kept]), time_s, MAX_GAP_S)

    def height_at(self, time_s: float) -> float | None:
        """The height nearest in time, None if that is more than a second away."""
        if not self._heights:
            return None
        kept_s, height_m = min(list(self._heights), key=lambda one: abs(one[0] - time_s))
        return height_m if abs(kept_s - time_s) <= MAX_HEIGHT_AGE_S else None
