"""The prequential figures of the online learner: every frame is scored before it is learned from."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame, FrameHeader
from horizon_dl.data.view import View
from horizon_dl.evaluation.protocols import WARM_UP_FRAMES
from horizon_dl.metrics.accumulator_state import (
    percentile_snapshot,
    ranging_snapshot,
    restore_percentile,
    restore_ranging,
    restored_tally,
    tally_snapshot,
)
from horizon_dl.metrics.accumulators import Tally, scored_pixels
from horizon_dl.metrics.metrics import SCHEMA, method_metrics
from horizon_dl.metrics.obstacle_height import by_height
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.metrics.roc import RocAccumulator, RocResult
from horizon_dl.metrics.running import RunningSides
from horizon_dl.models.dropout import single_pass_p_above
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.training.checkpoint import Snapshot
from horizon_dl.uncertainty.measures import Measures
from horizon_dl.uncertainty.percentile import RunningPercentile
from horizon_dl.uncertainty.scores import score_maps

SCORES = (
    "entropy",
    "expected_entropy",
    "mutual_information",
    "surprisal",
    "fused",
    "single_pass_entropy",
)


class OnlineFigures:
    """What a run has shown so far.

    Attributes:
        tally: of the labelled frames after the first 20, and of the sides of all frames after them.
        sides: running accuracy and calibration.
        reasons: frames not learned from, by reason.
        seen: frames that came; `predicted` could be, `learned` were learned from, `tested` scored with truth.
    """

    def __init__(self, config: Config, headers: Sequence[FrameHeader] = ()) -> None:
        self.tally = Tally(rocs={name: RocAccumulator() for name in SCORES})
        self.sides = RunningSides()
        self.reasons: Counter[str] = Counter()
        self.seen = self.predicted = self.learned = self.tested = 0
        self._config = config
        self._ranging = RangingBlock(headers)
        self._entropies = RunningPercentile(config.threshold.percentile)
        self._result: RocResult | None = None

    def timed(self, predict_s: float) -> None:
        """Count a prediction, of whatever frame."""
        self.predicted += 1
        self.tally.frames += 1
        self.tally.predict_s += predict_s

    def settled(self, not_learned: str | None) -> None:
        """Count a frame that was learned from, or why it was not."""
        if not_learned is None:
            self.learned += 1
        else:
            self.reasons[not_learned] += 1

    def predicted_frame(self, index: int, frame: Frame, view: View, found: Measures, net: HorizonFCN) -> None:
        """Count a prediction whose horizon can be believed.

        Args:
            index: of the frame in the stream.
            frame: with or without truth.
            view: of the frame.
            found: by the net as it was before it learned from the frame.
            net: that net.
        """
        band_rad = self._config.labels.band_rad
        self.sides.add(found.p_above, view.elevation, band_rad)
        if index >= WARM_UP_FRAMES:
            self.tally.add_sides(view, found.p_above, band_rad)
            if frame.truth is not None:
                self._score(frame, view, found, net)
        if self.learned:
            self._entropies.add(found.entropy)

    def auc(self) -> tuple[float | None, float | None]:
        """AUC of the entropy, pooled and within depression bands; None before any labelled frame."""
        if self._result is None and self.tested:
            self._result = self.tally.rocs["entropy"].result()
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
            "test": self.tested,
            "skipped": self.seen - self.learned,
        }
        rule = f"percentile-{self._config.threshold.percentile:g}"
        return {
            "schema": SCHEMA,
            "data": data,
            "protocol": "prequential",
            "seeds": [self._config.seed],
            "frames": frames,
            "methods": {"cnn": method_metrics([self.tally], rule)},
            "ranging": self._ranging.metrics(),
        }

    def snapshot(self) -> Snapshot:
        """All figures so far."""
        counts = {name: getattr(self, name) for name in ("seen", "predicted", "learned", "tested")}
        parts = {
            "ranging": ranging_snapshot(self._ranging),
            "counts": Snapshot(values={**counts, "reasons": dict(self.reasons)}),
            "tally": tally_snapshot(self.tally),
            "sides": self.sides.snapshot(),
            "entropies": percentile_snapshot(self._entropies),
        }
        return Snapshot.join(parts)

    def restore(self, snapshot: Snapshot) -> None:
        """The figures of a snapshot."""
        counts = dict(snapshot.part("counts").values)
        self.reasons = Counter(counts.pop("reasons"))
        for name, count in counts.items():
            setattr(self, name, count)
        self.tally = restored_tally(snapshot.part("tally"))
        self.sides.restore(snapshot.part("sides"))
        restore_percentile(self._entropies, snapshot.part("entropies"))
        restore_ranging(self._ranging, snapshot.part("ranging"))
        self._result = None

    def _score(self, frame: Frame, view: View, found: Measures, net: HorizonFCN) -> None:
        maps = score_maps(view, found, single_pass_p_above(net, view.image)[0])
        pixels = scored_pixels(frame)
        others = {"above": scored_pixels(frame, above=True), **by_height(frame, pixels)}
        self.tally.add_scores(maps, pixels, others)
        self.tally.threshold = self._entropies.value()
        self.tally.add_obstacle_map(found.entropy, self.tally.threshold, pixels)
        self._ranging.add(frame, found.p_above, self.tally.threshold)
        self.tested += 1
        self._result = None
