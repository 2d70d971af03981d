"""From accumulators to `metrics.json`: means over seeds, and their spread."""

from collections.abc import Mapping, Sequence
from statistics import fmean, stdev
from typing import Any, cast

from horizon_dl.metrics.method_accumulator import MethodAccumulator, MethodFigures
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.metrics.roc import RocResult
from horizon_dl.uncertainty.taught_threshold import RULE

SCHEMA = 1
FIGURES = ("auc", "auc_within_depression", "ap", "fpr90", "fpr95", "best_f1")


def mean_and_spread(name: str, values: Sequence[float | None]) -> dict[str, float | None]:
    """`{name: mean, name_sd: sample standard deviation}`, null where none is known; sd 0 for one seed."""
    known = [value for value in values if value is not None]
    if not known:
        return {name: None, f"{name}_sd": None}
    return {name: fmean(known), f"{name}_sd": stdev(known) if len(known) > 1 else 0.0}


def metrics_file(
    data: str,
    protocol: str,
    seeds: Sequence[int],
    frames: Mapping[str, int],
    accumulators: Mapping[str, Sequence[MethodAccumulator]],
    rule: str,
    ranging: RangingBlock,
) -> dict[str, Any]:
    """The content of `metrics.json`.

    Args:
        data: name of the recording.
        protocol: `tail`, `labelled-out`, `prequential` or `evaluate`.
        seeds: of the learners.
        frames: how many were to `train`, to `test`, and `skipped`.
        accumulators: by method, one a seed.
        rule: name of the thresholds' rule.
        ranging: the distances of one learner.
    """
    return {
        "schema": SCHEMA,
        "data": data,
        "protocol": protocol,
        "seeds": list(seeds),
        "frames": dict(frames),
        "methods": {name: method_metrics(found, rule) for name, found in accumulators.items()},
        "ranging": ranging.compute(),
    }


def method_metrics(accumulators: Sequence[MethodAccumulator], rule: str) -> dict[str, Any]:
    """The block of one method; one accumulator a seed.

    Beside the fixed keys, where there is truth for it: `calibration`, the expected calibration error of
    `p_above`; `above`, obstacle against ceiling and sky above the horizon; `crossing` and `low`, floor
    against the obstacles that reach the camera's height and those that do not (`obstacle_height.py`).
    """
    found = [one.compute() for one in accumulators]
    block: dict[str, Any] = {"scores": _scores([one.scores for one in found])}
    if any(one.sides for one in accumulators):
        block |= mean_and_spread("horizon_accuracy", [one.horizon_accuracy for one in found])
        block["calibration"] = mean_and_spread("ece", [one.calibration_error for one in found])
    block["train_s"] = fmean(one.train_s for one in accumulators)
    block["predict_ms_per_frame"] = fmean(one.predict_ms for one in found)
    if any(accumulator.threshold is not None for accumulator in accumulators):
        block["operating_point"] = _operating_point(accumulators, found, rule)
    if any(accumulator.simulated_threshold is not None for accumulator in accumulators):
        block["operating_point_simulated"] = _simulated_point(accumulators)
    for other in found[0].others:
        block |= _other_metrics(other, [one.others[other] for one in found])
    return block


def _other_metrics(name: str, results: Sequence[Mapping[str, RocResult]]) -> dict[str, Any]:
    """`{name: {obstacles, others, scores}}`: pixels and figures; empty where a class is missing."""
    counted = next(iter(results[0].values()))
    if not counted.positives or not counted.negatives:
        return {}
    return {name: {"obstacles": counted.positives, "others": counted.negatives, "scores": _scores(results)}}


def _scores(results: Sequence[Mapping[str, RocResult]]) -> dict[str, dict[str, float | None]]:
    return {name: _score_metrics([one[name] for one in results]) for name in results[0]}


def _score_metrics(results: Sequence[RocResult]) -> dict[str, float | None]:
    block: dict[str, float | None] = {}
    for figure in FIGURES:
        block |= mean_and_spread(figure, [getattr(result, figure) for result in results])
    return block


def _simulated_point(accumulators: Sequence[MethodAccumulator]) -> dict[str, Any]:
    """Threshold and rates by the rule that asks the simulated worlds' net."""
    known = [one for one in accumulators if one.simulated_threshold is not None]
    rates = [one.rocs["entropy"].rates_at(cast(float, one.simulated_threshold)) for one in known]
    columns: Mapping[str, list[float | None]] = {
        "threshold": [one.simulated_threshold for one in known],
        "tpr": [tpr for tpr, _ in rates],
        "fpr": [fpr for _, fpr in rates],
    }
    return {name: mean_and_spread(name, values)[name] for name, values in columns.items()} | {"rule": RULE}


def _operating_point(
    accumulators: Sequence[MethodAccumulator], found: Sequence[MethodFigures], rule: str
) -> dict[str, Any]:
    """Rates before (`tpr`, `fpr`) and after the neighbour filter."""
    columns: Mapping[str, list[float | None]] = {
        "threshold": [accumulator.threshold for accumulator in accumulators],
        "tpr": [one.rates[0] for one in found],
        "fpr": [one.rates[1] for one in found],
        "tpr_filtered": [one.filtered_rates[0] for one in found],
        "fpr_filtered": [one.filtered_rates[1] for one in found],
    }
    return {name: mean_and_spread(name, values)[name] for name, values in columns.items()} | {"rule": rule}
