"""The paper's threshold: a percentile of the training uncertainties, in bounded memory."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

BINS = 4096
MOST_FRAMES = 50
"""Training frames that the threshold is taken from, at most, evenly spread."""


class PaperThreshold:
    """Percentile of the entropies of the pixels that are learned from, to 1/4096 bit.

    Those are the pixels with a label: outside the ignored band around the horizon. No obstacle label is used.
    Source: arXiv:1806.08007, which takes the 25th percentile.

    Attributes:
        percentile: in (0, 100).
        counts: pixels by bin of their entropy.

    Example:
        >>> threshold = PaperThreshold(25.0)
        >>> threshold.update(np.linspace(0, 1, 1001), np.ones(1001, bool))
        >>> abs(threshold.compute() - 0.25) < 1e-3, threshold.rule
        (True, 'percentile-25')
    """

    def __init__(self, percentile: float) -> None:
        self.percentile = percentile
        self.counts = np.zeros(BINS, np.int64)

    @property
    def rule(self) -> str:
        """The rule's name in `metrics.json` and `card.json`."""
        return f"percentile-{self.percentile:g}"

    def update(self, entropy: NDArray[np.floating], labelled: NDArray[np.bool_]) -> None:
        """Count the entropies, bits in [0, 1], of a frame's pixels where `labelled`; NaN is left out."""
        chosen = entropy[labelled]
        known = chosen[~np.isnan(chosen)].clip(0.0, 1.0)
        self.counts += np.bincount(np.minimum((known * BINS).astype(int), BINS - 1), minlength=BINS)

    def merge(self, other: "PaperThreshold") -> None:
        """Add everything that another one has counted."""
        self.counts += other.counts

    def compute(self) -> float:
        """The threshold, bits, interpolated within its bin; 0 before any pixel."""
        if not self.counts.any():
            return 0.0
        share = self.percentile / 100 * self.counts.sum()
        cumulated = np.concatenate([[0], np.cumsum(self.counts)])
        return float(np.interp(share, cumulated, np.linspace(0.0, 1.0, BINS + 1)))

    def state(self) -> dict[str, NDArray[Any]]:
        """All that was counted, as arrays by name."""
        return {"counts": self.counts.copy()}

    def load(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a state."""
        self.counts[:] = state["counts"]


def paper_threshold(
    frames: Iterable[tuple[NDArray[np.floating], NDArray[np.bool_]]], percentile: float
) -> float:
    """The threshold, bits, over the entropies of many frames and where each is labelled."""
    threshold = PaperThreshold(percentile)
    for entropy, labelled in frames:
        threshold.update(entropy, labelled)
    return threshold.compute()
