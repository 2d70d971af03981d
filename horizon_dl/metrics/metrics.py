"""From tallies to `metrics.json`: means over seeds, and their spread."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from statistics import fmean, stdev
from typing import Any

from horizon_dl.metrics.accumulators import Tally
from horizon_dl.metrics.roc import RocAccumulator

SCHEMA = 1
FIGURES = ("auc", "auc_within_depression", "ap", "fpr95", "best_f1")


def mean_and_spread(name: str, values: Sequence[float | None]) -> dict[str, float | None]:
    """`{name: mean, name_sd: sample standard deviation}`, null where none is known; sd 0 for one seed."""
    known = [value for value in values if value is not None]
    if not known:
        return {name: None, f"{name}_sd": None}
    return {name: fmean(known), f"{name}_sd": stdev(known) if len(known) > 1 else 0.0}


def method_metrics(tallies: Sequence[Tally], rule: str) -> dict[str, Any]:
    """The block of one method; one tally a seed.

    Beside the fixed keys, where there is truth for it: `calibration`, the expected calibration error of
    `p_above`; `above`, obstacle against ceiling and sky above the horizon; `crossing` and `low`, floor
    against the obstacles that reach the camera's height and those that do not (`second_truth.py`).
    """
    block: dict[str, Any] = {"scores": _scores([tally.rocs for tally in tallies])}
    if any(tally.sides for tally in tallies):
        accuracy = [tally.right_sides / tally.sides if tally.sides else None for tally in tallies]
        block |= mean_and_spread("horizon_accuracy", accuracy)
        block["calibration"] = mean_and_spread("ece", [tally.calibration.error() for tally in tallies])
    block["train_s"] = fmean(tally.train_s for tally in tallies)
    block["predict_ms_per_frame"] = fmean(1e3 * tally.predict_s / max(tally.frames, 1) for tally in tallies)
    if any(tally.threshold is not None for tally in tallies):
        block["operating_point"] = _operating_point(tallies, rule)
    for other in tallies[0].other_rocs:
        block |= _other_metrics(other, [tally.other_rocs[other] for tally in tallies])
    return block


def _other_metrics(name: str, rocs: Sequence[Mapping[str, RocAccumulator]]) -> dict[str, Any]:
    """`{name: {obstacles, others, scores}}`: pixels and figures; empty where a class is missing."""
    counted = next(iter(rocs[0].values())).result()
    if not counted.positives or not counted.negatives:
        return {}
    return {name: {"obstacles": counted.positives, "others": counted.negatives, "scores": _scores(rocs)}}


def _scores(rocs: Sequence[Mapping[str, RocAccumulator]]) -> dict[str, dict[str, float | None]]:
    return {name: _score_metrics([one[name] for one in rocs]) for name in rocs[0]}


def _score_metrics(rocs: Sequence[RocAccumulator]) -> dict[str, float | None]:
    results = [asdict(roc.result()) for roc in rocs]
    block: dict[str, float | None] = {}
    for figure in FIGURES:
        block |= mean_and_spread(figure, [result[figure] for result in results])
    return block


def _operating_point(tallies: Sequence[Tally], rule: str) -> dict[str, Any]:
    """Rates before (`tpr`, `fpr`) and after the neighbour filter."""
    raw = [tally.raw.rates() for tally in tallies]
    filtered = [tally.filtered.rates() for tally in tallies]
    columns: Mapping[str, list[float | None]] = {
        "threshold": [tally.threshold for tally in tallies],
        "tpr": [tpr for tpr, _ in raw],
        "fpr": [fpr for _, fpr in raw],
        "tpr_filtered": [tpr for tpr, _ in filtered],
        "fpr_filtered": [fpr for _, fpr in filtered],
    }
    return {name: mean_and_spread(name, values)[name] for name, values in columns.items()} | {"rule": rule}
