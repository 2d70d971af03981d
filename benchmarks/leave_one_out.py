"""Named variants of the default on every set, and what a choice among them is worth where it was not made.

`python benchmarks/leave_one_out.py --out FOLDER --seeds 3` trains every variant on every set below
HORIZON_DL_DATA and on the embedded one (protocol labelled-out), keeps nets and figures in FOLDER, so that it
can be stopped and goes on, and prints: AUC of a score, pooled / within depression bands; worst set and mean;
and, for every set, the variant that is best on all the others, with what it has on the one left out. A choice
is by the mean of the mean and the worst set within bands. `--worlds 10` adds ten simulated worlds of each
kind that taught the start. Two may run at once into one folder, each with its `--sets`, and a third then
prints all.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, pstdev

from nets import all_sets, net_method, scored, trained_net
from simulated_start import KINDS

from horizon_dl.output import write_json
from horizon_dl.reporting.table import format_markdown
from horizon_dl.simulation.simulate import simulate

WORLD_FRAMES = 120


@dataclass(frozen=True)
class Variant:
    """What is other than the default.

    Attributes:
        overrides: of the configuration.
    """

    overrides: Sequence[str] = ()


PLAIN = tuple(
    f"geodesic.{key}={value}"
    for key, value in {
        "chroma": 1.0,
        "edge_power": 1.0,
        "edge_limit": 1000.0,
        "blur": 0.0036,
        "length_cost": 0.02,
    }.items()
)
VARIANTS = {
    "default": Variant(),
    "random start": Variant(("model.start=random",)),
    "start alone": Variant(("train.simulated_share=0",)),
    "context never": Variant(("train.context_agreement=2",)),
    "context always": Variant(("train.context_agreement=-1",)),
    "context from .65": Variant(("train.context_agreement=0.65",)),
    "no pastes": Variant(("train.pastes=0",)),
    "six pastes": Variant(("train.pastes=6",)),
    "plain path costs": Variant(PLAIN),
    "crops of 128": Variant(("train.crop=128", "train.batch=7")),
    "dropout .5": Variant(("model.dropout=0.5",)),
    "two rounds": Variant(("train.rounds=[150, 400]",)),
    "one round": Variant(("train.rounds=[550]",)),
}

Pair = tuple[float, float]
"""AUC pooled and within depression bands."""
Figures = dict[str, dict[str, list[Pair]]]
"""By variant and set, one pair a seed."""


def main() -> None:
    """Train, score, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder for nets and figures")
    parser.add_argument("--seeds", type=int, default=3, help="how many, from 0 on")
    parser.add_argument("--sets", nargs="+", default=all_sets(), help="names of the sets")
    parser.add_argument("--variants", nargs="+", default=list(VARIANTS), choices=list(VARIANTS))
    parser.add_argument("--score", default="entropy", help="a score of the net")
    parser.add_argument("--worlds", type=int, default=0, help="simulated worlds of each kind")
    args = parser.parse_args()
    args.sets += [str(folder) for folder in simulated_worlds(args.out.resolve() / "worlds", args.worlds)]
    figures: Figures = {
        variant: {
            name: [measured(args.out, variant, name, seed)[args.score] for seed in range(args.seeds)]
            for name in args.sets
        }
        for variant in args.variants
    }
    print(markdown(figures))


def measured(out: Path, variant: str, name: str, seed: int) -> dict[str, Pair]:
    """Figures by score of one net, from `out` if it was scored before."""
    folder = out / variant.replace(" ", "_")
    path = folder / f"{Path(name).name}_{seed}.json"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        chosen = VARIANTS[variant]
        net = trained_net(folder, name, seed, chosen.overrides)
        results = {
            score: roc.compute()
            for score, roc in scored(name, {"cnn": net_method(name, net)})["cnn"].rocs.items()
        }
        write_json(
            path, {score: (found.auc, found.auc_within_depression) for score, found in results.items()}
        )
    return {score: (pair[0], pair[1]) for score, pair in json.loads(path.read_text()).items()}


def simulated_worlds(folder: Path, count: int) -> list[Path]:
    """The first seeds of each kind of world that taught the start, rendered where they are missing."""
    worlds = {folder / f"{world}_{seed}": (world, seed) for seed in range(count) for world in KINDS}
    for path, (world, seed) in worlds.items():
        if not (path / "camera.yaml").exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            simulate(path, frames=WORLD_FRAMES, seed=seed, world=world)
    return list(worlds)


def markdown(figures: Figures) -> str:
    """Both tables, and how many variants were tried."""
    sets = list(next(iter(figures.values())))
    rows = [
        [
            variant,
            *(cell(found[name]) for name in sets),
            *(f"{value:.3f}" for value in (worst(found), mean(found))),
        ]
        for variant, found in figures.items()
    ]
    lines = [
        format_markdown(
            ["variant", *(Path(name).name for name in sets), "worst, within", "mean, within"], rows
        )
    ]
    if len(figures) > 1 and len(sets) > 1:
        choices = left_out(figures)
        cells = [
            [Path(name).name, variant, cell(figures[variant][name])] for name, variant in choices.items()
        ]
        lines.append(format_markdown(["left out", "best on the others", "on the one left out"], cells))
        reached = {name: figures[variant][name] for name, variant in choices.items()}
        lines.append(f"Chosen so: worst set {worst(reached):.3f}, mean {mean(reached):.3f} within bands.")
    lines.append(f"{len(figures)} variants tried.")
    return "\n\n".join(lines)


def left_out(figures: Figures) -> dict[str, str]:
    """By set, the variant that is best on all other sets."""

    def merit(variant: str, without: str) -> float:
        others = {name: pairs for name, pairs in figures[variant].items() if name != without}
        return (worst(others) + mean(others)) / 2

    sets = next(iter(figures.values()))
    return {name: max(figures, key=lambda variant: merit(variant, name)) for name in sets}


def worst(found: Mapping[str, Sequence[Pair]]) -> float:
    """The set with the least mean over the seeds, within bands."""
    return min(fmean(within for _, within in pairs) for pairs in found.values())


def mean(found: Mapping[str, Sequence[Pair]]) -> float:
    """Mean over sets and seeds, within bands."""
    return fmean(fmean(within for _, within in pairs) for pairs in found.values())


def cell(pairs: Sequence[Pair]) -> str:
    """Pooled / within, with the larger deviation over the seeds where there are several."""
    pooled, within = zip(*pairs, strict=True)
    spread = f" (±{max(pstdev(pooled), pstdev(within)):.3f})" if len(pairs) > 1 else ""
    return f"{fmean(pooled):.3f} / {fmean(within):.3f}{spread}"


if __name__ == "__main__":
    main()
