"""The prequential figures of the online learner: every frame is scored before it is learned from."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame, FrameHeader
from horizon_dl.data.view import View
from horizon_dl.evaluation.progressive import ProgressiveValidation
from horizon_dl.evaluation.scoring import count_distances
from horizon_dl.methods.names import NET
from horizon_dl.methods.scores import SCORES, score_maps
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metric_snapshot import metric_snapshot, restore_metric
from horizon_dl.metrics.metrics import metrics_file
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.metrics.roc import RocAccumulator, RocResult
from horizon_dl.metrics.running import RunningSides
from horizon_dl.training.checkpoint import Snapshot
from horizon_dl.uncertainty.measures import P_ABOVE, Measures

Map = NDArray[np.float32]


class OnlineFigures:
    """What a run has shown so far.

    Attributes:
        validation: the net's figures, each frame scored before it was learned from.
        ranging: the distances of those frames.
        sides: running accuracy and calibration.
        reasons: frames not learned from, by reason.
        seen: frames that came; `predicted` could be, `learned` were learned from.
    """

    def __init__(self, config: Config, headers: Sequence[FrameHeader] = ()) -> None:
        self.validation = ProgressiveValidation((NET,), config)
        self.ranging = RangingBlock(headers, config.ranging_params)
        self.accumulator.rocs |= {name: RocAccumulator() for name in SCORES}
        self.sides = RunningSides()
        self.reasons: Counter[str] = Counter()
        self.seen = self.predicted = self.learned = 0
        self._config = config
        self._result: RocResult | None = None

    @property
    def accumulator(self) -> MethodAccumulator:
        """Of the labelled frames after the first 20, and of the sides of all frames after them."""
        return self.validation.accumulators[NET]

    def timed(self, predict_s: float) -> None:
        """Count a prediction, of whatever frame."""
        self.predicted += 1
        self.accumulator.frames += 1
        self.accumulator.predict_s += predict_s

    def settled(self, not_learned: str | None) -> None:
        """Count a frame that was learned from, or why it was not."""
        if not_learned is None:
            self.learned += 1
        else:
            self.reasons[not_learned] += 1

    def predicted_frame(
        self, index: int, frame: Frame, view: View, found: Measures, single_pass: Callable[[View], Map]
    ) -> None:
        """Count a prediction whose horizon can be believed.

        Args:
            index: of the frame in the stream.
            frame: with or without truth.
            view: of the frame.
            found: by the net as it was before it learned from the frame.
            single_pass: gives `p_above` of a view without dropout, (1, h, w), by that net.
        """
        self.sides.update(found.p_above, view.elevation, self._config.labels.band_rad)
        if not self.learned:
            return
        maps = {P_ABOVE: found.p_above, "entropy": found.entropy}
        if self.validation.scores(index, frame):
            maps = score_maps(view, found, single_pass(view)[0], self._config.geodesic)
            self._result = None
        scored = self.validation.update(index, frame, view, {NET: maps})
        if scored is not None:
            count_distances(self.ranging, scored)

    def auc(self) -> tuple[float | None, float | None]:
        """AUC of the entropy, pooled and within depression bands; None before any labelled frame."""
        if self._result is None and self.validation.tested:
            self._result = self.accumulator.rocs["entropy"].compute()
        return (self._result.auc, self._result.auc_within_depression) if self._result else (None, None)

    def counts(self) -> dict[str, Any]:
        """Frames by what became of them."""
        return {
            "seen": self.seen,
            "predicted": self.predicted,
            "learned": self.learned,
            "not_learned": dict(sorted(self.reasons.items())),
        }

    def metrics(self, data: str) -> dict[str, Any]:
        """The content of `metrics.json`, as `compare --protocol prequential` writes it of the net."""
        frames = {
            "train": self.learned,
            "test": self.validation.tested,
            "skipped": self.seen - self.learned,
        }
        found, rule = {NET: [self.accumulator]}, self.validation.thresholds[NET].rule
        return metrics_file(data, "prequential", [self._config.seed], frames, found, rule, self.ranging)

    def snapshot(self) -> Snapshot:
        """All figures so far."""
        counts = {name: getattr(self, name) for name in ("seen", "predicted", "learned")}
        parts = {
            "ranging": metric_snapshot(self.ranging),
            "counts": Snapshot(
                values={**counts, "tested": self.validation.tested, "reasons": dict(self.reasons)}
            ),
            "accumulator": metric_snapshot(self.accumulator),
            "sides": metric_snapshot(self.sides),
            "entropies": metric_snapshot(self.validation.thresholds[NET]),
        }
        return Snapshot.join(parts)

    def restore(self, snapshot: Snapshot) -> None:
        """The figures of a snapshot."""
        counts = dict(snapshot.part("counts").values)
        self.reasons = Counter(counts.pop("reasons"))
        self.validation.tested = counts.pop("tested")
        for name, count in counts.items():
            setattr(self, name, count)
        restore_metric(self.accumulator, snapshot.part("accumulator"))
        restore_metric(self.sides, snapshot.part("sides"))
        restore_metric(self.validation.thresholds[NET], snapshot.part("entropies"))
        restore_metric(self.ranging, snapshot.part("ranging"))
        self._result = None
