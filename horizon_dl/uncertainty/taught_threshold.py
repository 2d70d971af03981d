"""A threshold from what a teacher says of unlabelled pixels, in bounded memory."""

import numpy as np
from numpy.typing import NDArray

BINS = 4096
OBSTACLE = 0.3
"""What the teacher calls an obstacle with at least this probability. Picked with the rule itself, among 25 on
eight sets (docs/RESEARCH.md)."""
RULE = "youden-simulated"


class TaughtThreshold:
    """The entropy that tells best what a teacher calls obstacle from what it calls floor.

    It has the largest true- less false-positive rate (Youden 1950) against the teacher's word. No label of
    the frames is used.

    Attributes:
        counts: pixels by what they are called (floor, obstacle) and by bin of their entropy.

    Example:
        >>> threshold = TaughtThreshold()
        >>> threshold.update(np.array([0.125, 0.25, 0.5, 0.75]), np.array([0.0, 0.1, 0.8, 0.9]))
        >>> threshold.compute()
        0.5
    """

    def __init__(self) -> None:
        self.counts = np.zeros((2, BINS), np.int64)

    def update(self, entropy: NDArray[np.floating], p_obstacle: NDArray[np.floating]) -> None:
        """Count pixels below the horizon.

        Args:
            entropy: (n,) bits in [0, 1]; NaN is left out.
            p_obstacle: (n,) the teacher's probabilities.
        """
        known = ~np.isnan(entropy)
        bins = np.minimum((entropy[known].clip(0.0, 1.0) * BINS).astype(int), BINS - 1)
        np.add.at(self.counts, ((p_obstacle[known] >= OBSTACLE).astype(int), bins), 1)

    def compute(self) -> float | None:
        """Bits, to 1/4096; None where the teacher knows one kind alone, or no entropy parts them."""
        floor, obstacle = self.counts
        if not floor.any() or not obstacle.any():
            return None
        # Rates of what lies at or over each bin; its lower edge is the threshold.
        over = [np.cumsum(kind[::-1])[::-1] / kind.sum() for kind in (obstacle, floor)]
        gain = over[0] - over[1]
        return float(np.argmax(gain) / BINS) if gain.max() > 0.0 else None
