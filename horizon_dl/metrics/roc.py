"""ROC of obstacles against floor, streamed: memory does not grow with the number of frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.metrics.metric import State

BANDS = 90  # of one degree of depression below the horizon
BINS = 8192
# float32 just below 1 has a logit of 16.6; towards 0 it is much finer.
LOGIT_RANGE = (-36.0, 17.0)

Counts = NDArray[np.int64]


@dataclass(frozen=True)
class RocResult:
    """Figures of one score, pooled over all pixels; None where a class is missing.

    Attributes:
        auc: probability that an obstacle pixel scores above a floor pixel, ties half.
        auc_within_depression: the same over pairs within the same degree of depression only.
        ap: average precision, the sum of precision times gain in recall.
        fpr90: false-positive rate at the first threshold with a true-positive rate of 90 % or more.
        fpr95: the same at 95 %.
        best_f1: best F1 over all thresholds.
        positives: obstacle pixels.
        negatives: floor pixels.
    """

    auc: float | None
    auc_within_depression: float | None
    ap: float | None
    fpr90: float | None
    fpr95: float | None
    best_f1: float | None
    positives: int
    negatives: int


class RocAccumulator:
    """Histograms of scores per degree of depression and class.

    Bins are uniform in logit(score), so scores close to 0 or 1 keep their order; scores in one bin count as
    tied. Figures agree with the exact ones to about 1e-3 or better.

    Attributes:
        counts: pixels by degree of depression, class (floor, obstacle) and bin.

    Example:
        >>> roc = RocAccumulator()
        >>> roc.update(np.array([0.9, 0.2]), np.array([True, False]), np.array([0.1, 0.1]))
        >>> roc.compute().auc
        1.0
    """

    def __init__(self) -> None:
        # Zeros take no memory until written, so bands that never occur are free.
        self.counts: Counts = np.zeros((BANDS, 2, BINS), np.int64)

    def update(
        self,
        score: NDArray[np.floating],
        positive: NDArray[np.bool_],
        depression_rad: NDArray[np.floating],
    ) -> None:
        """Count pixels.

        Args:
            score: (n,) in [0, 1].
            positive: (n,) True for obstacle, False for floor.
            depression_rad: (n,) angle below the horizon, in [0, pi / 2].

        Raises:
            ValueError: if shapes differ, or a score or depression is NaN or out of range.
        """
        if score.ndim != 1 or not score.shape == positive.shape == depression_rad.shape:
            shapes = f"{score.shape}, {positive.shape}, {depression_rad.shape}"
            raise ValueError(f"needs three arrays of one length, not {shapes}")
        if not ((score >= 0.0) & (score <= 1.0)).all():
            raise ValueError("scores must lie in [0, 1] and not be NaN")
        if not ((depression_rad >= 0.0) & (depression_rad <= np.pi / 2.0 + 1e-6)).all():
            raise ValueError("depressions must lie in [0, pi / 2] rad and not be NaN")
        band = np.minimum(np.rad2deg(depression_rad).astype(np.intp), BANDS - 1)
        np.add.at(self.counts, (band, positive.astype(np.intp), score_bin(score)), 1)

    def merge(self, other: "RocAccumulator") -> None:
        """Add everything that another one has counted."""
        self.counts += other.counts

    def state(self) -> State:
        """The places of the histogram that hold anything, and how much: most are empty."""
        counts = self.counts.ravel()
        places = np.flatnonzero(counts)
        return {"places": places.astype(np.int32), "counts": counts[places]}

    def load(self, state: State) -> None:
        """See `Metric`."""
        self.counts = np.zeros((BANDS, 2, BINS), np.int64)
        self.counts.ravel()[state["places"]] = state["counts"]

    def compute(self) -> RocResult:
        """All figures of what was counted so far."""
        floor, obstacle = self._pooled()
        positives, negatives = int(obstacle.sum()), int(floor.sum())
        within = _auc(self.counts[:, 0], self.counts[:, 1])
        if not positives or not negatives:
            return RocResult(None, within, None, None, None, None, positives, negatives)
        tp, fp = _descending(obstacle), _descending(floor)
        precision = tp / np.maximum(tp + fp, 1)
        return RocResult(
            auc=_auc(floor[None], obstacle[None]),
            auc_within_depression=within,
            ap=float(np.sum(np.diff(tp, prepend=0) * precision) / positives),
            fpr90=float(fp[np.argmax(tp >= 0.90 * positives)] / negatives),
            fpr95=float(fp[np.argmax(tp >= 0.95 * positives)] / negatives),
            best_f1=float(np.max(2 * tp / (tp + fp + positives))),
            positives=positives,
            negatives=negatives,
        )

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """False- and true-positive rates from (0, 0) to (1, 1), threshold falling.

        None where a class is missing.
        """
        floor, obstacle = self._pooled()
        if not floor.any() or not obstacle.any():
            return None
        fp, tp = _descending(floor), _descending(obstacle)
        steps = np.flatnonzero(np.diff(fp + tp, prepend=0))
        fpr = np.concatenate([[0.0], fp[steps] / fp[-1]])
        tpr = np.concatenate([[0.0], tp[steps] / tp[-1]])
        return fpr, tpr

    def rates_at(self, threshold: float) -> tuple[float | None, float | None]:
        """True- and false-positive rate of `score > threshold`, to one bin; None for a missing class."""
        floor, obstacle = self._pooled()
        first = int(score_bin(np.array([threshold]))[0]) + 1
        return _share(obstacle, first), _share(floor, first)

    def rates_at_all(
        self, thresholds: NDArray[np.floating]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """True- and false-positive rates of `score > threshold` at many; None where a class is missing."""
        floor, obstacle = self._pooled()
        if not floor.any() or not obstacle.any():
            return None
        first = score_bin(np.asarray(thresholds)) + 1
        tp, fp = (np.append(np.cumsum(counts[::-1])[::-1], 0) for counts in (obstacle, floor))
        return tp[first] / tp[0], fp[first] / fp[0]

    def _pooled(self) -> tuple[Counts, Counts]:
        """Floor and obstacle counts per bin over all bands."""
        pooled = self.counts.sum(axis=0)
        return pooled[0], pooled[1]


def frame_auc(score: NDArray[np.floating], positive: NDArray[np.bool_]) -> float | None:
    """AUC of the scores, (n,) in [0, 1], of one frame; None where a class is missing.

    Example:
        >>> frame_auc(np.array([0.9, 0.2]), np.array([True, False]))
        1.0
    """
    bins = score_bin(score)
    floor, obstacle = (np.bincount(bins[positive == kind], minlength=BINS) for kind in (False, True))
    return _auc(floor[None], obstacle[None])


def score_bin(score: NDArray[np.floating]) -> NDArray[np.intp]:
    """Bin of each score, 0 .. BINS - 1, rising with the score: uniform in the clipped logit."""
    exact = score.astype(np.float64)
    with np.errstate(divide="ignore"):
        logit = np.log(exact) - np.log1p(-exact)
    low, high = LOGIT_RANGE
    position = (np.clip(logit, low, high) - low) / (high - low)
    bins: NDArray[np.intp] = np.minimum((position * BINS).astype(np.intp), BINS - 1)
    return bins


def _descending(counts: Counts) -> Counts:
    """Cumulated counts from the highest bin down."""
    return np.cumsum(counts[::-1])


def _auc(floor: Counts, obstacle: Counts) -> float | None:
    """Share of obstacle-floor pairs ranked rightly, ties half: counts (bands, bins), pairs within a band."""
    used = floor.any(axis=1) & obstacle.any(axis=1)
    if not used.any():
        return None
    floor, obstacle = floor[used].astype(np.float64), obstacle[used].astype(np.float64)
    below = np.cumsum(floor, axis=1) - 0.5 * floor
    pairs = floor.sum(axis=1) @ obstacle.sum(axis=1)
    return float((below * obstacle).sum() / pairs)


def _share(counts: Counts, first: int) -> float | None:
    total = counts.sum()
    return float(counts[first:].sum() / total) if total else None
