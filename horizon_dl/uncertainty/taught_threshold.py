"""A threshold from what a teacher says of unlabelled pixels, in bounded memory."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

BINS = 4096
OBSTACLE = 0.3
"""What the teacher calls an obstacle with at least this probability. Picked with the rule itself, among 25 on
eight sets (docs/RESEARCH.md)."""
RULE = "youden-simulated"


def taught_threshold(frames: Iterable[tuple[NDArray[np.floating], NDArray[np.floating]]]) -> float | None:
    """The entropy that tells best what a teacher calls obstacle from what it calls floor.

    It has the largest true- less false-positive rate (Youden 1950) against the teacher's word. No label of
    the frames is used.

    Args:
        frames: entropies, bits in [0, 1], of a frame's pixels below the horizon, and the teacher's
            probabilities of an obstacle there.

    Returns:
        bits, to 1/4096; None where the teacher knows one kind alone, or no entropy parts them.

    Example:
        >>> taught_threshold([(np.array([0.1, 0.2, 0.6, 0.9]), np.array([0.0, 0.1, 0.8, 0.9]))])
        0.599853515625
    """
    counts = np.zeros((2, BINS), np.int64)
    for entropy, p_obstacle in frames:
        known = ~np.isnan(entropy)
        bins = np.minimum((entropy[known].clip(0.0, 1.0) * BINS).astype(int), BINS - 1)
        for kind, chosen in enumerate((p_obstacle[known] < OBSTACLE, p_obstacle[known] >= OBSTACLE)):
            counts[kind] += np.bincount(bins[chosen], minlength=BINS)
    floor, obstacle = counts
    if not floor.any() or not obstacle.any():
        return None
    # Rates of what lies at or over each bin; its lower edge is the threshold.
    over = [np.cumsum(kind[::-1])[::-1] / kind.sum() for kind in (obstacle, floor)]
    gain = over[0] - over[1]
    return float(np.argmax(gain) / BINS) if gain.max() > 0.0 else None
