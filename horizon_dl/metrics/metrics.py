"""From accumulators to `metrics.json`: means over seeds, and their spread."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from statistics import fmean, stdev
from typing import Any

from horizon_dl.metrics.accumulators import MethodAccumulator
from horizon_dl.metrics.roc import RocAccumulator

SCHEMA = 1
FIGURES = ("auc", "auc_within_depression", "ap", "fpr90", "fpr95", "best_f1")


def mean_and_spread(name: str, values: Sequence[float | None]) -> dict[str, float | None]:
    """`{name: mean, name_sd: sample standard deviation}`, null where none is known; sd 0 for one seed."""
    known = [value for value in values if value is not None]
    if not known:
        return {name: None, f"{name}_sd": None}
    return {name: fmean(known), f"{name}_sd": stdev(known) if len(known) > 1 else 0.0}


def method_metrics(accumulators: Sequence[MethodAccumulator], rule: str) -> dict[str, Any]:
    """The block of one method; one accumulator a seed.

    Beside the fixed keys, where there is truth for it: `calibration`, the expected calibration error of
    `p_above`; `above`, obstacle against ceiling and sky above the horizon; `crossing` and `low`, floor
    against the obstacles that reach the camera's height and those that do not (`second_truth.py`).
    """
    block: dict[str, Any] = {"scores": _scores([one.rocs for one in accumulators])}
    if any(one.sides for one in accumulators):
        accuracy = [one.right_sides / one.sides if one.sides else None for one in accumulators]
        block |= mean_and_spread("horizon_accuracy", accuracy)
        block["calibration"] = mean_and_spread("ece", [one.calibration.compute() for one in accumulators])
    block["train_s"] = fmean(one.train_s for one in accumulators)
    block["predict_ms_per_frame"] = fmean(1e3 * one.predict_s / max(one.frames, 1) for one in accumulators)
    if any(accumulator.threshold is not None for accumulator in accumulators):
        block["operating_point"] = _operating_point(accumulators, rule)
    for other in accumulators[0].other_rocs:
        block |= _other_metrics(other, [accumulator.other_rocs[other] for accumulator in accumulators])
    return block


def _other_metrics(name: str, rocs: Sequence[Mapping[str, RocAccumulator]]) -> dict[str, Any]:
    """`{name: {obstacles, others, scores}}`: pixels and figures; empty where a class is missing."""
    counted = next(iter(rocs[0].values())).compute()
    if not counted.positives or not counted.negatives:
        return {}
    return {name: {"obstacles": counted.positives, "others": counted.negatives, "scores": _scores(rocs)}}


def _scores(rocs: Sequence[Mapping[str, RocAccumulator]]) -> dict[str, dict[str, float | None]]:
    return {name: _score_metrics([one[name] for one in rocs]) for name in rocs[0]}


def _score_metrics(rocs: Sequence[RocAccumulator]) -> dict[str, float | None]:
    results = [asdict(roc.compute()) for roc in rocs]
    block: dict[str, float | None] = {}
    for figure in FIGURES:
        block |= mean_and_spread(figure, [result[figure] for result in results])
    return block


def _operating_point(accumulators: Sequence[MethodAccumulator], rule: str) -> dict[str, Any]:
    """Rates before (`tpr`, `fpr`) and after the neighbour filter."""
    raw = [accumulator.raw.compute() for accumulator in accumulators]
    filtered = [accumulator.filtered.compute() for accumulator in accumulators]
    columns: Mapping[str, list[float | None]] = {
        "threshold": [accumulator.threshold for accumulator in accumulators],
        "tpr": [tpr for tpr, _ in raw],
        "fpr": [fpr for _, fpr in raw],
        "tpr_filtered": [tpr for tpr, _ in filtered],
        "fpr_filtered": [fpr for _, fpr in filtered],
    }
    return {name: mean_and_spread(name, values)[name] for name, values in columns.items()} | {"rule": rule}
