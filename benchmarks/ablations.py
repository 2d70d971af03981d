"""The default with some values changed, one row each."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from methods import cell
from nets import net_method, scored, trained_net

from horizon_dl.metrics.metrics import method_metrics
from horizon_dl.reporting.table import format_markdown

ABLATIONS: dict[str, tuple[str, ...]] = {
    "hard labels": ("target.kind=hard", "train.rounds=[450]"),
    "guided targets": ("target.kind=guided", "train.rounds=[450]"),
    "geodesic, image edges only (one round)": ("train.rounds=[450]",),
    "without the path from the sure floor": ("target.kind=one_way_geodesic",),
    "no dropout in training": ("model.dropout=0.0",),
    "random start": ("model.start=random",),
    "half as wide, random start": ("model.channels=16",),
}


def ablation_figures(name: str, ablation: str, seeds: Sequence[int], folder: Path) -> dict[str, Any]:
    """The net's block under changed values."""
    nets = [trained_net(folder, name, seed, ABLATIONS[ablation]) for seed in seeds]
    return method_metrics([scored(name, {"cnn": net_method(name, net)})["cnn"] for net in nets], "none")


def ablation_markdown(found: Mapping[str, Any], methods: Mapping[str, Any] | None) -> str:
    """The net's entropy, the default first where the methods were measured, too."""
    sets = list(next(iter(found.values())))
    rows = [
        [name, *(cell(by_set[one]["scores"]["entropy"]) for one in sets)] for name, by_set in found.items()
    ]
    if methods:
        rows.insert(0, ["default", *(cell(methods[one]["cnn"]["scores"]["entropy"]) for one in sets)])
    table = format_markdown(["ablation, entropy", *sets], rows)
    return f"## Ablations\n\nTwo seeds at most; the default three.\n\n{table}"
