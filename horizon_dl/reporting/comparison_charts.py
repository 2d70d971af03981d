"""The charts of a comparison: ROC of every method, reliability of the learners."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evaluation.compare import Comparison
from horizon_dl.methods.names import TRAINING_FREE, printed_name
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.roc import LOGIT_RANGE, RocAccumulator
from horizon_dl.reporting.chart import Chart, Line
from horizon_dl.reporting.conclusion import headline_score
from horizon_dl.reporting.curves import OperatingPoint, RocLine, thin_curve
from horizon_dl.runtime.prediction import FLOWN_SCORE, PAPER_SCORE

FUSED = "fused"
NOTES = {FLOWN_SCORE: "flown", PAPER_SCORE: "the paper's", FUSED: "evaluated only"}


def pooled_roc(accumulators: Sequence[MethodAccumulator], score: str) -> RocAccumulator | None:
    """A score's counts over all seeds."""
    if not any(score in accumulator.rocs for accumulator in accumulators):
        return None
    pooled = RocAccumulator()
    for accumulator in accumulators:
        if score in accumulator.rocs:
            pooled.merge(accumulator.rocs[score])
    return pooled


def _drawn(comparison: Comparison) -> list[tuple[str, str, str]]:
    """Method, score and name of every curve: each method's headline, and the learners' other scores."""
    found = []
    for method in comparison.accumulators:
        scores = (headline_score(method),) if method in TRAINING_FREE else tuple(NOTES)
        for score in dict.fromkeys(scores):
            name = printed_name(method)
            if method not in TRAINING_FREE:
                name += f", {score} ({NOTES[score]})"
            found.append((method, score, name))
    return found


def roc_lines(comparison: Comparison) -> list[RocLine]:
    """The curves pooled over seeds, for the figure in a file."""
    lines = []
    for method, score, name in _drawn(comparison):
        pooled = pooled_roc(comparison.accumulators[method], score)
        curve = None if pooled is None else pooled.curve()
        if curve is None:
            continue
        block = comparison.metrics["methods"][method]
        points = _points(block.get("operating_point")) if score == PAPER_SCORE else []
        auc = block["scores"][score]["auc"]
        lines.append(RocLine(name, *curve, auc=auc, baseline=method in TRAINING_FREE, points=points))
    return lines


def roc_chart(comparison: Comparison) -> Chart | None:
    """All curves with their thresholds on hover; the mark moves with the frames' threshold."""
    lines = []
    for method, score, name in _drawn(comparison):
        pooled = pooled_roc(comparison.accumulators[method], score)
        if pooled is None:
            continue
        thresholds = 1.0 / (1.0 + np.exp(-np.linspace(*LOGIT_RANGE, 1500)))
        rates = pooled.rates_at_all(thresholds)
        if rates is None:
            continue
        auc = comparison.metrics["methods"][method]["scores"][score]["auc"]
        tpr, fpr = (np.concatenate([[1.0], one, [0.0]]) for one in rates)
        x, y = thin_curve(fpr[::-1], tpr[::-1], 90)
        notes = [f"threshold {_threshold_at(fpr, tpr, thresholds, a, b)}" for a, b in zip(x, y, strict=True)]
        points = [(round(float(a), 4), round(float(b), 4)) for a, b in zip(x, y, strict=True)]
        lines.append(Line(f"{name}: {auc:.3f}", points, baseline=method in TRAINING_FREE, notes=notes))
    if not lines:
        return None
    caption = (
        "ROC over all scored pixels below the horizon, with the AUC; the mark is the threshold set above."
    )
    alt = "ROC curves. " + "; ".join(line.name for line in lines) + "."
    axes = "floor called obstacle (FPR)", "obstacles found (TPR)"
    return Chart(lines, *axes, caption=caption, alt=alt, diagonal=True, name="roc")


def _threshold_at(
    fpr: NDArray[np.float64], tpr: NDArray[np.float64], thresholds: NDArray[np.float64], x: float, y: float
) -> str:
    index = int(np.argmin(np.abs(fpr - x) + np.abs(tpr - y))) - 1
    return f"{thresholds[min(max(index, 0), len(thresholds) - 1)]:.3f}"


def calibration_chart(comparison: Comparison) -> Chart | None:
    """The learners' reliability over all seeds, their expected calibration errors in the legend."""
    lines = []
    for method, accumulators in comparison.accumulators.items():
        pooled = Reliability()
        for accumulator in accumulators:
            pooled.merge(accumulator.calibration)
        if (error := pooled.compute()) is None:
            continue
        predicted, observed, counts = pooled.curve()
        points = [(float(x), float(y)) for x, y in zip(predicted, observed, strict=True) if np.isfinite(x)]
        notes = [f"{count} pixels" for count in counts.tolist() if count]
        lines.append(Line(f"{printed_name(method)}, error {error:.3f}", points, notes=notes))
    if not lines:
        return None
    caption = "Calibration of p_above. Softened targets keep the net unsure where the plain side is certain."
    alt = "Reliability. " + "; ".join(line.name for line in lines) + "."
    axes = "predicted p_above", "share really above the horizon"
    return Chart(lines, *axes, caption=caption, alt=alt, diagonal=True)


def _points(point: dict[str, Any] | None) -> list[OperatingPoint]:
    if not point or point["tpr"] is None or point["fpr"] is None:
        return []
    return [
        OperatingPoint(point["fpr"], point["tpr"]),
        OperatingPoint(point["fpr_filtered"], point["tpr_filtered"], filtered=True),
    ]
