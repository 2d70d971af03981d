"""What one method earns on the test frames."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.view import View
from horizon_dl.geometry.horizon import ABOVE, IGNORED, horizon_label
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.metric import Metric, State, joined_states, names_in, part_of
from horizon_dl.metrics.roc import RocAccumulator, RocResult
from horizon_dl.metrics.scored_pixels import Confusion, ScoredPixels, enlarged
from horizon_dl.uncertainty.measures import P_ABOVE
from horizon_dl.uncertainty.obstacle_map import without_lone_pixels

Rates = tuple[float | None, float | None]
THRESHOLDS = ("threshold", "simulated_threshold")
SUMS = ("right_sides", "sides", "frames", "predict_s", "train_s")
ROCS, OTHERS = "rocs", "others"


@dataclass(frozen=True)
class MethodFigures:
    """Figures of one method under one seed.

    Attributes:
        scores: by score, below the horizon.
        others: of other pixels than those, by their name and by score.
        horizon_accuracy: share of the pixels whose side was predicted; None before any.
        calibration_error: expected one of `p_above`; None before any.
        rates: true- and false-positive rate of the paper's obstacle map.
        filtered_rates: the same without lone pixels.
        predict_ms: a frame.
    """

    scores: dict[str, RocResult]
    others: dict[str, dict[str, RocResult]]
    horizon_accuracy: float | None
    calibration_error: float | None
    rates: Rates
    filtered_rates: Rates
    predict_ms: float


@dataclass
class MethodAccumulator:
    """Figures of one method under one seed, gathered frame by frame in bounded memory.

    Attributes:
        rocs: by score, below the horizon.
        other_rocs: of other pixels than those, by their name and by score: `above`, `crossing`, `low`.
        calibration: of `p_above`, outside the ignore band.
        threshold: the paper's, of the entropy, bits; None for methods without one.
        simulated_threshold: another one, see `TaughtThreshold`.
    """

    rocs: dict[str, RocAccumulator] = field(default_factory=dict)
    other_rocs: dict[str, dict[str, RocAccumulator]] = field(default_factory=dict)
    calibration: Reliability = field(default_factory=Reliability)
    raw: Confusion = field(default_factory=Confusion)
    filtered: Confusion = field(default_factory=Confusion)
    threshold: float | None = None
    simulated_threshold: float | None = None
    right_sides: int = 0
    sides: int = 0
    frames: int = 0
    predict_s: float = 0.0
    train_s: float = 0.0

    def update(
        self,
        view: View,
        maps: Mapping[str, NDArray[np.float32]],
        pixels: ScoredPixels,
        others: Mapping[str, ScoredPixels],
        *,
        band_rad: float,
        threshold: float | None = None,
    ) -> None:
        """Count what the method says of one frame.

        Args:
            view: of the frame.
            maps: by score, (h, w) in [0, 1]; learners also give `p_above`.
            pixels: where it is scored.
            others: other pixels by name.
            band_rad: around the horizon, where no side is asked for.
            threshold: the paper's, of the entropy, bits; None for methods without one.
        """
        if P_ABOVE in maps:
            self.add_sides(view, maps[P_ABOVE], band_rad)
        self.add_scores(maps, pixels, others)
        if threshold is not None:
            self.threshold = threshold
            self.add_obstacle_map(maps["entropy"], threshold, pixels)

    def add_time(self, seconds: float) -> None:
        """Count a frame and the time its prediction took."""
        self.frames += 1
        self.predict_s += seconds

    def add_scores(
        self,
        maps: Mapping[str, NDArray[np.float32]],
        pixels: ScoredPixels,
        others: Mapping[str, ScoredPixels] | None = None,
    ) -> None:
        """Count every score map (all but `p_above`) at the scored pixels, and at others by name."""
        for name, score in maps.items():
            if name != P_ABOVE:
                values = enlarged(score, pixels.mask.shape)
                _add_to(self.rocs, name, values, pixels)
                for other, its_pixels in (others or {}).items():
                    if its_pixels.mask.any():
                        _add_to(self.other_rocs.setdefault(other, {}), name, values, its_pixels)

    def add_obstacle_map(self, score: NDArray[np.float32], threshold: float, pixels: ScoredPixels) -> None:
        """Count the obstacle map before and after its filter."""
        over = score > threshold
        self.raw.update(over, pixels)
        self.filtered.update(without_lone_pixels(over), pixels)

    def add_sides(self, view: View, p_above: NDArray[np.float32], band_rad: float) -> None:
        """Count the pixels outside the ignore band whose side of the horizon was predicted rightly."""
        label = horizon_label(view.elevation, band_rad)
        counts = label != IGNORED
        above = label[counts] == ABOVE
        self.right_sides += int(np.sum((p_above > 0.5)[counts] == above))
        self.sides += int(np.sum(counts))
        self.calibration.update(p_above[counts], above)

    def merge(self, other: "MethodAccumulator") -> None:
        """See `Metric`; a threshold is kept where there is one."""
        _merge_rocs(self.rocs, other.rocs)
        for name, by_score in other.other_rocs.items():
            _merge_rocs(self.other_rocs.setdefault(name, {}), by_score)
        self.calibration.merge(other.calibration)
        self.raw.merge(other.raw)
        self.filtered.merge(other.filtered)
        for name in THRESHOLDS:
            setattr(self, name, getattr(other if getattr(self, name) is None else self, name))
        for name in SUMS:
            setattr(self, name, getattr(self, name) + getattr(other, name))

    def compute(self) -> MethodFigures:
        """See `MethodFigures`."""
        return MethodFigures(
            {name: roc.compute() for name, roc in self.rocs.items()},
            {
                other: {name: roc.compute() for name, roc in by_score.items()}
                for other, by_score in self.other_rocs.items()
            },
            self.right_sides / self.sides if self.sides else None,
            self.calibration.compute(),
            self.raw.compute(),
            self.filtered.compute(),
            1e3 * self.predict_s / max(self.frames, 1),
        )

    def state(self) -> State:
        """See `Metric`; scalars as arrays of one, NaN for no threshold."""
        others = {f"{OTHERS}.{name}": by_score for name, by_score in self.other_rocs.items()}
        rocs = {
            f"{kind}.{name}": roc
            for kind, by_score in {ROCS: self.rocs, **others}.items()
            for name, roc in by_score.items()
        }
        sums = {name: np.array(getattr(self, name)) for name in SUMS}
        known = {name: getattr(self, name) for name in THRESHOLDS}
        thresholds = {name: np.array(np.nan if one is None else one) for name, one in known.items()}
        return {**sums, **thresholds, **joined_states({**self._counts(), **rocs})}

    def load(self, state: State) -> None:
        """See `Metric`."""
        for name in SUMS:
            setattr(self, name, state[name].item())
        for name in THRESHOLDS:
            value = state[name].item()
            setattr(self, name, None if np.isnan(value) else value)
        for name, metric in self._counts().items():
            metric.load(part_of(state, name))
        self.rocs = _rocs_of(part_of(state, ROCS))
        others = part_of(state, OTHERS)
        self.other_rocs = {name: _rocs_of(part_of(others, name)) for name in names_in(others)}

    def _counts(self) -> dict[str, Metric]:
        return {"calibration": self.calibration, "raw": self.raw, "filtered": self.filtered}


def _add_to(
    rocs: dict[str, RocAccumulator], name: str, values: NDArray[np.float32], pixels: ScoredPixels
) -> None:
    roc = rocs.setdefault(name, RocAccumulator())
    roc.update(values[pixels.mask], pixels.obstacle, pixels.depression_rad)


def _merge_rocs(into: dict[str, RocAccumulator], other: Mapping[str, RocAccumulator]) -> None:
    for name, roc in other.items():
        into.setdefault(name, RocAccumulator()).merge(roc)


def _rocs_of(state: State) -> dict[str, RocAccumulator]:
    found = {}
    for name in names_in(state):
        found[name] = RocAccumulator()
        found[name].load(part_of(state, name))
    return found
