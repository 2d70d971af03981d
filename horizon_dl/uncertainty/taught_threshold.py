"""A threshold from what a teacher says of unlabelled pixels, in bounded memory."""

import numpy as np
from numpy.typing import NDArray

BINS = 4096
FALSE_POSITIVE_WEIGHT = 0.75
"""What a false positive counts beside a miss; picked with the rule on eight sets (docs/RESEARCH.md)."""
LEAST_SHARE = 0.05
"""Of the pixels that a teacher must call floor, and obstacle, to be asked where both part; either was .2
to .8 of them in eight recordings and twelve simulated worlds."""
RULE = "youden-simulated"


class TaughtThreshold:
    """The entropy that tells best what a teacher calls obstacle from what it calls floor.

    Every pixel is an obstacle by as much as the teacher holds it for one, and floor by the rest. Of all
    thresholds it has the largest true- less weighted false-positive rate (Youden's index of 1950, with a
    weight). No label of the frames is used.

    Attributes:
        counts: pixels by kind (floor, obstacle) and by bin of their entropy, by as much as each is of a kind.
        called: pixels by the kind that they rather are.

    Example:
        >>> threshold = TaughtThreshold()
        >>> threshold.update(np.array([0.125, 0.25, 0.5, 0.75]), np.array([0.0, 0.1, 0.8, 0.9]))
        >>> 0.25 < threshold.compute() <= 0.5
        True
    """

    def __init__(self) -> None:
        self.counts = np.zeros((2, BINS))
        self.called = np.zeros(2)

    def update(self, entropy: NDArray[np.floating], p_obstacle: NDArray[np.floating]) -> None:
        """Count pixels below the horizon.

        Args:
            entropy: (n,) bits in [0, 1]; NaN is left out.
            p_obstacle: (n,) the teacher's probabilities.
        """
        known = ~np.isnan(entropy)
        obstacles = int((p_obstacle[known] >= 0.5).sum())
        self.called += (int(known.sum()) - obstacles, obstacles)
        bins = np.minimum((entropy[known].clip(0.0, 1.0) * BINS).astype(int), BINS - 1)
        for kind, share in zip(self.counts, (1.0 - p_obstacle[known], p_obstacle[known]), strict=True):
            kind += np.bincount(bins, weights=share, minlength=BINS)

    def compute(self) -> float | None:
        """Bits, to 1/4096; None where the teacher sees hardly anything but one kind, or no entropy parts both
        better than taking everything for an obstacle.
        """
        floor, obstacle = self.counts
        if self.called.min() < LEAST_SHARE * max(self.called.sum(), 1.0):
            return None
        # Rates of what lies at or over each bin; its lower edge is the threshold.
        over = [np.cumsum(kind[::-1])[::-1] / kind.sum() for kind in (obstacle, floor)]
        best = int(np.argmax(over[0] - FALSE_POSITIVE_WEIGHT * over[1]))
        return best / BINS if best else None
