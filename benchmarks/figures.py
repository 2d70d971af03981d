"""The README's figures from scratch: every set, every method, three seeds, and the ablations.

    HORIZON_DL_DATA=DIR python benchmarks/figures.py --out figures

Takes about an hour on 2 cores. Writes figures.md and figures.json with seeds, versions and machine. DIR holds
data sets, one a folder; the embedded set is added.
"""

import argparse
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from horizon_dl.config import Config, load_config
from horizon_dl.evaluation.compare import compare, score_frames, split_recording
from horizon_dl.evaluation.learners import NetMethod
from horizon_dl.evaluation.metrics import method_metrics
from horizon_dl.evaluation.tally import Tally
from horizon_dl.frames.formats import open_recording
from horizon_dl.frames.frame import Recording
from horizon_dl.learning.store import FrameStore
from horizon_dl.learning.train import train_net
from horizon_dl.output import output_folder, write_json, write_text
from horizon_dl.provenance import machine, versions
from horizon_dl.reporting.table import format_markdown
from horizon_dl.simulation.embedded import embedded_set

SETS = ("arena", "corridor", "hallway", "kitti")


@dataclass(frozen=True)
class Ablation:
    """The default with some values changed."""

    name: str
    overrides: tuple[str, ...]


ABLATIONS = (
    Ablation("default", ()),
    Ablation("hard labels", ("target.kind=hard", "train.rounds=[350]")),
    Ablation("guided targets", ("target.kind=guided", "train.rounds=[350]")),
    Ablation("geodesic, image edges only (one round)", ("train.rounds=[350]",)),
    Ablation("no dropout in training", ("model.dropout=0.0",)),
    Ablation("dropout 0.5", ("model.dropout=0.5",)),
    Ablation("crops of 64", ("train.crop=64", "train.batch=36")),
    Ablation("half as wide", ("model.channels=16",)),
    Ablation("ResNet-18 encoder, random weights", ("model.kind=resnet18",)),
)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("figures"))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--only", choices=("methods", "ablations"), help="one half of the tables")
    arguments = parser.parse_args()
    recordings = {"embedded": open_recording(embedded_set())}
    folder = Path(os.environ["HORIZON_DL_DATA"])
    recordings |= {name: open_recording(folder / name) for name in SETS if (folder / name).is_dir()}
    seeds = range(arguments.seeds)
    found: dict[str, Any] = {"seeds": list(seeds), "versions": versions(), "machine": machine()}
    if arguments.only != "ablations":
        found["methods"] = {name: all_methods(recording, seeds) for name, recording in recordings.items()}
    if arguments.only != "methods":
        found["ablations"] = {
            ablation.name: {
                name: ablated(recording, ablation, seeds) for name, recording in recordings.items()
            }
            for ablation in ABLATIONS
        }
    with output_folder(arguments.out) as out:
        write_json(out / "figures.json", found)
        write_text(out / "figures.md", as_markdown(found))
    print(as_markdown(found))


def all_methods(recording: Recording, seeds: Sequence[int]) -> dict[str, Any]:
    """The blocks of `metrics.json`, protocol labelled-out."""
    metrics = compare(recording, load_config(), "labelled-out", seeds, progress=True).metrics
    methods: dict[str, Any] = metrics["methods"]
    return methods


def ablated(recording: Recording, ablation: Ablation, seeds: Sequence[int]) -> dict[str, Any]:
    """The net's block under changed values."""
    config = load_config(None, ablation.overrides)
    return method_metrics([_net_tally(recording, config, seed) for seed in seeds], "none")


def _net_tally(recording: Recording, config: Config, seed: int) -> Tally:
    split = split_recording(recording, "labelled-out")
    store = FrameStore(recording, config)
    net = train_net(store, split.train, seed=seed)
    return score_frames({"cnn": NetMethod(net)}, {}, store.frames(split.test), config.labels.band_rad)["cnn"]


def as_markdown(found: dict[str, Any]) -> str:
    """Both tables; every cell is the pooled AUC / the AUC within depression bands."""
    blocks = []
    if "methods" in found:
        sets = list(found["methods"])
        rows = [
            [f"{method}, {score}", *(cell(found["methods"][name][method]["scores"][score]) for name in sets)]
            for method, block in found["methods"][sets[0]].items()
            for score in block["scores"]
        ]
        blocks.append(format_markdown(["method, score", *sets], rows))
    if "ablations" in found:
        sets = list(next(iter(found["ablations"].values())))
        rows = [
            [name, *(cell(by_set[one]["scores"]["entropy"]) for one in sets)]
            for name, by_set in found["ablations"].items()
        ]
        blocks.append(format_markdown(["ablation, entropy", *sets], rows))
    blocks.append(f"Seeds {found['seeds']}; {', '.join(map(str, found['machine'].values()))}.")
    return "\n\n".join(blocks) + "\n"


def cell(figures: dict[str, float]) -> str:
    """Pooled / within, and the larger of their spreads over the seeds."""
    spread = max(figures["auc_sd"], figures["auc_within_depression_sd"])
    return f"{figures['auc']:.3f} / {figures['auc_within_depression']:.3f} (±{spread:.3f})"


if __name__ == "__main__":
    main()
