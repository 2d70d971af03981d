"""A percentile of a stream of scores, in bounded memory."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

BINS = 4096


class RunningPercentile:
    """Percentile of all scores in [0, 1] seen so far, to 1/4096.

    Attributes:
        counts: scores by bin.

    Example:
        >>> scores = RunningPercentile(25.0)
        >>> scores.add(np.linspace(0, 1, 1001))
        >>> abs(scores.value() - 0.25) < 1e-3
        True
    """

    def __init__(self, percentile: float) -> None:
        self.percentile = percentile
        self.counts = np.zeros(BINS, np.int64)

    def add(self, scores: NDArray[np.floating]) -> None:
        """Count scores of any shape; NaN is left out."""
        known = scores[~np.isnan(scores)].clip(0.0, 1.0)
        self.counts += np.bincount(np.minimum((known * BINS).astype(int), BINS - 1), minlength=BINS)

    def value(self) -> float:
        """The percentile, interpolated within its bin; 0 before any score."""
        if not self.counts.any():
            return 0.0
        share = self.percentile / 100 * self.counts.sum()
        cumulated = np.concatenate([[0], np.cumsum(self.counts)])
        return float(np.interp(share, cumulated, np.linspace(0.0, 1.0, BINS + 1)))


def stream_percentile(maps: Iterable[NDArray[np.floating]], percentile: float) -> float:
    """Percentile of the scores of many maps, read one at a time: the paper's threshold takes the 25th."""
    scores = RunningPercentile(percentile)
    for scores_of_one in maps:
        scores.add(scores_of_one)
    return scores.value()
