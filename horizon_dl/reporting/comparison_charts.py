"""The charts of a comparison: ROC of every method, reliability of the learners, distances over truth."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evaluation.compare import Comparison
from horizon_dl.metrics.accumulators import Tally
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.roc import LOGIT_RANGE, RocAccumulator
from horizon_dl.reporting.chart import Chart, Line
from horizon_dl.reporting.comparison_log import ComparisonLog
from horizon_dl.reporting.conclusion import NO_LEARNING, headline_score
from horizon_dl.reporting.curves import OperatingPoint, RocLine, thin_curve
from horizon_dl.reporting.sections import Heading, Section, Table
from horizon_dl.reporting.table import METHOD_NAMES
from horizon_dl.runtime.prediction import DRAWN_SCORE

BEST = "fused"
MOST_DISTANCES = 1500
SHARES = 4


def pooled_roc(tallies: Sequence[Tally], score: str) -> RocAccumulator | None:
    """A score's counts over all seeds."""
    if not any(score in tally.rocs for tally in tallies):
        return None
    pooled = RocAccumulator()
    for tally in tallies:
        if score in tally.rocs:
            pooled.merge(tally.rocs[score])
    return pooled


def _drawn(comparison: Comparison) -> list[tuple[str, str, str]]:
    """Method, score and name of every curve: each method's headline, and the learners' fused score."""
    found = []
    for method in comparison.tallies:
        scores = (headline_score(method),) if method in NO_LEARNING else (DRAWN_SCORE, BEST)
        for score in dict.fromkeys(scores):
            name = METHOD_NAMES.get(method, method)
            if method not in NO_LEARNING:
                name += f", {score.replace('_', ' ')}"
            found.append((method, score, name))
    return found


def roc_lines(comparison: Comparison) -> list[RocLine]:
    """The curves pooled over seeds, for the figure in a file."""
    lines = []
    for method, score, name in _drawn(comparison):
        pooled = pooled_roc(comparison.tallies[method], score)
        curve = None if pooled is None else pooled.curve()
        if curve is None:
            continue
        block = comparison.metrics["methods"][method]
        own = score == headline_score(method)
        points = _points(block.get("operating_point")) if own else []
        auc = block["scores"][score]["auc"]
        lines.append(RocLine(name, *curve, auc=auc, baseline=method in NO_LEARNING, points=points))
    return lines


def roc_chart(comparison: Comparison) -> Chart | None:
    """All curves with their thresholds on hover; the mark moves with the frames' threshold."""
    lines = []
    for method, score, name in _drawn(comparison):
        pooled = pooled_roc(comparison.tallies[method], score)
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
        lines.append(Line(f"{name}: {auc:.3f}", points, baseline=method in NO_LEARNING, notes=notes))
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
    for method, tallies in comparison.tallies.items():
        pooled = Reliability()
        for tally in tallies:
            pooled.merge(tally.calibration)
        if (error := pooled.error()) is None:
            continue
        predicted, observed, counts = pooled.curve()
        points = [(float(x), float(y)) for x, y in zip(predicted, observed, strict=True) if np.isfinite(x)]
        notes = [f"{count} pixels" for count in counts.tolist() if count]
        lines.append(Line(f"{METHOD_NAMES[method]}, error {error:.3f}", points, notes=notes))
    if not lines:
        return None
    caption = "Calibration of p_above. Softened targets keep the net unsure where the plain side is certain."
    alt = "Reliability. " + "; ".join(line.name for line in lines) + "."
    axes = "predicted p_above", "share really above the horizon"
    return Chart(lines, *axes, caption=caption, alt=alt, diagonal=True)


def distance_sections(metrics: dict[str, Any], log: ComparisonLog) -> list[Section]:
    """Stated over true distances with a table; nothing where none were measured."""
    block = metrics.get("ranging") or {}
    if not block.get("columns") or not (log.distances or log.covered):
        return []
    pairs = [*log.distances, *log.covered]
    far_m = float(np.ceil(1.3 * max(block["interval_m"][1], 1.0)))
    lines = [
        Line(name, _thinned(points, far_m), dots=True)
        for name, points in (("foot in view", log.distances), ("at most: foot out of view", log.covered))
        if points
    ]
    caption = (
        f"Nearest obstacle of each degree of bearing, {len(pairs)} bearings; the dotted line is the truth."
    )
    median = block["median_relative_error"]
    alt = f"Stated over true distance; median error {_percent(median)} of the distance."
    axes = "measured, m", "stated, m"
    chart = Chart(lines, *axes, (0.0, far_m), (0.0, far_m), caption, alt, diagonal=True, name="distances")
    return [Heading("Distances"), chart, _distance_table(log, block), _ranging_table(block)]


def _thinned(points: list[tuple[float, float]], far_m: float) -> list[tuple[float, float | None]]:
    kept = [(x, y) for x, y in points if x <= far_m]
    step = max(1, -(-len(kept) // MOST_DISTANCES))
    return [(round(x, 2), round(min(y, far_m), 2)) for x, y in kept[::step]]


def _distance_table(log: ComparisonLog, block: dict[str, Any]) -> Table:
    near_m, far_m = block["interval_m"]
    edges = np.linspace(near_m, far_m, SHARES + 1)
    truth, stated = np.array(log.distances or [(np.nan, np.nan)]).T
    rows = []
    for low, high in pairwise(edges.tolist()):
        used = (truth >= low) & (truth < high)
        error = (stated[used] - truth[used]) / truth[used]
        shown = (
            ["-", "-"] if not used.any() else [_percent(np.median(np.abs(error))), _percent(np.median(error))]
        )
        rows.append([f"{low:.1f} to {high:.1f} m", str(int(used.sum())), *shown])
    header = ("true distance", "bearings", "median error", "median of too far (+) or near (-)")
    return Table(header, rows, "Bearings whose obstacle has its foot in view.")


def _ranging_table(block: dict[str, Any]) -> Table:
    header = ("floor", "bearings", "median error", "missed", "false stops", "within two stated deviations")
    rows = []
    for name, one in (("the learner's", block), ("the truth's own", block.get("true_floor"))):
        if one and one.get("columns"):
            shares = (one[key] for key in ("median_relative_error", "missed", "false_stop", "within_2sd"))
            rows.append([name, str(one["columns"]), *map(_percent, shares)])
    near_m, far_m = block["interval_m"]
    caption = (
        f"True distances of {near_m:g} to {far_m:g} m. Missed: said to be free beyond 1.5 times them. "
        "False stop: said to be under 0.67 times."
    )
    return Table(header, rows, caption)


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f} %"


def _points(point: dict[str, Any] | None) -> list[OperatingPoint]:
    if not point or point["tpr"] is None or point["fpr"] is None:
        return []
    return [
        OperatingPoint(point["fpr"], point["tpr"]),
        OperatingPoint(point["fpr_filtered"], point["tpr_filtered"], filtered=True),
    ]
