"""From tallies to `metrics.json`: means over seeds, and their spread."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from statistics import fmean, stdev
from typing import Any

from horizon_dl.evaluation.tally import Tally

SCHEMA = 1
FIGURES = ("auc", "auc_within_depression", "ap", "fpr95", "best_f1")


def mean_and_spread(name: str, values: Sequence[float | None]) -> dict[str, float | None]:
    """`{name: mean, name_sd: sample standard deviation}`, null where none is known; sd 0 for one seed."""
    known = [value for value in values if value is not None]
    if not known:
        return {name: None, f"{name}_sd": None}
    return {name: fmean(known), f"{name}_sd": stdev(known) if len(known) > 1 else 0.0}


def method_metrics(tallies: Sequence[Tally], rule: str) -> dict[str, Any]:
    """The block of one method; one tally a seed."""
    block: dict[str, Any] = {"scores": {name: _score_metrics(tallies, name) for name in tallies[0].rocs}}
    if any(tally.sides for tally in tallies):
        accuracy = [tally.right_sides / tally.sides if tally.sides else None for tally in tallies]
        block |= mean_and_spread("horizon_accuracy", accuracy)
    block["train_s"] = fmean(tally.train_s for tally in tallies)
    block["predict_ms_per_frame"] = fmean(1e3 * tally.predict_s / max(tally.frames, 1) for tally in tallies)
    if any(tally.threshold is not None for tally in tallies):
        block["operating_point"] = _operating_point(tallies, rule)
    return block


def _score_metrics(tallies: Sequence[Tally], name: str) -> dict[str, float | None]:
    results = [asdict(tally.rocs[name].result()) for tally in tallies]
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
