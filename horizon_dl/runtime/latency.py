"""A histogram of durations in bounded memory."""

import numpy as np

BIN_S = 1e-3
BINS = 5000


class Latencies:
    """Counts durations to the millisecond; those over 5 s count as 5 s.

    Example:
        >>> found = Latencies()
        >>> for milliseconds in range(1, 100):
        ...     found.add(milliseconds / 1e3)
        >>> round(found.percentile_ms(50))
        50
    """

    def __init__(self) -> None:
        self._counts = np.zeros(BINS, np.int64)

    @property
    def count(self) -> int:
        """How many there were."""
        return int(self._counts.sum())

    def add(self, seconds: float) -> None:
        """Count one."""
        self._counts[min(max(int(seconds / BIN_S), 0), BINS - 1)] += 1

    def percentile_ms(self, percentile: float) -> float | None:
        """Milliseconds, to one; None before any."""
        if not self.count:
            return None
        rank = percentile / 100 * self.count
        return float(np.searchsorted(np.cumsum(self._counts), rank) + 0.5) * BIN_S * 1e3

    def summary(self) -> dict[str, float | int | None]:
        """Count, median, 99th percentile and maximum."""
        return {
            "count": self.count,
            "median_ms": self.percentile_ms(50),
            "p99_ms": self.percentile_ms(99),
            "max_ms": self.percentile_ms(100),
        }
