"""Calibration of `p_above` against the side of the horizon, streamed."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.metrics.metric import State, loaded

BINS = 20

Floats = NDArray[np.float64]


class Reliability:
    """Predicted probability against the share really above, in bins of equal width.

    The expected calibration error is that of Guo et al., On calibration of modern neural networks, ICML
    2017, eq. 3 for a yes or no: the mean over all pixels of the gap between the mean prediction and the
    share really above in the pixel's bin. A net trained on softened targets is unsure where it could be
    sure: its error measures that, too.

    Example:
        >>> calibration = Reliability()
        >>> calibration.update(np.array([0.9, 0.9]), np.array([True, False]))
        >>> round(calibration.compute(), 6)
        0.4
    """

    def __init__(self, bins: int = BINS) -> None:
        self._counts = np.zeros(bins, np.int64)
        self._predicted = np.zeros(bins)
        self._above = np.zeros(bins)

    def update(self, p_above: NDArray[np.floating], above: NDArray[np.bool_]) -> None:
        """Count pixels: `p_above` (n,) in [0, 1], and (n,) whether each is above the horizon."""
        bins = len(self._counts)
        index = np.minimum((p_above * bins).astype(np.intp), bins - 1)
        self._counts += np.bincount(index, minlength=bins)
        self._predicted += np.bincount(index, weights=p_above, minlength=bins)
        self._above += np.bincount(index, weights=above, minlength=bins)

    def merge(self, other: "Reliability") -> None:
        """Add everything that another one with as many bins has counted."""
        self._counts += other._counts
        self._predicted += other._predicted
        self._above += other._above

    def state(self) -> State:
        """Pixels, sum of the predictions, and pixels really above, of every bin."""
        return {
            "counts": self._counts.copy(),
            "predicted": self._predicted.copy(),
            "above": self._above.copy(),
        }

    def load(self, state: State) -> None:
        """See `Metric`."""
        self._counts = loaded(state["counts"], self._counts)
        self._predicted = loaded(state["predicted"], self._predicted)
        self._above = loaded(state["above"], self._above)

    def curve(self) -> tuple[Floats, Floats, NDArray[np.int64]]:
        """Mean prediction, share really above (both NaN where there is none), and pixels of every bin."""
        with np.errstate(invalid="ignore"):
            return self._predicted / self._counts, self._above / self._counts, self._counts.copy()

    def compute(self) -> float | None:
        """The expected calibration error, in [0, 1]; None before any pixel was counted."""
        total = self._counts.sum()
        return float(np.abs(self._predicted - self._above).sum() / total) if total else None
