"""What nets say of themselves without a label against what they are worth: does the number know?

`python benchmarks/self_assessment.py --out FOLDER` reads the default's nets and figures of
`leave_one_out.py` in FOLDER (it makes what is missing), prints share, verdict and AUC within depression
bands of every set, and the rank correlation over the sets; `--worlds N` adds simulated worlds, `--plot
FILE` draws it.
"""

import argparse
from pathlib import Path
from statistics import fmean

import matplotlib.pyplot as plt
from leave_one_out import measured, simulated_worlds
from nets import all_sets, store_of, trained_net
from scipy.stats import spearmanr

from horizon_dl.evaluation.compare import split_recording
from horizon_dl.evidence.self_assessment import DOUBTFUL, NOT_TO_BE_TRUSTED, verdict
from horizon_dl.reporting.table import format_markdown
from horizon_dl.training.train import evidence_of

VARIANT = "default"


def main() -> None:
    """Ask the nets, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder of leave_one_out.py")
    parser.add_argument("--seeds", type=int, default=3, help="how many, from 0 on")
    parser.add_argument("--world-seeds", type=int, default=1, help="of the nets of simulated worlds")
    parser.add_argument("--sets", nargs="+", default=all_sets(), help="names of the sets")
    parser.add_argument("--worlds", type=int, default=0, help="simulated worlds of each kind")
    parser.add_argument("--plot", type=Path, help="SVG to write")
    args = parser.parse_args()
    worlds = [str(world) for world in simulated_worlds(args.out.resolve() / "worlds", args.worlds)]
    sets = {name: figures(args.out, name, args.seeds) for name in args.sets}
    simulated = {name: figures(args.out, name, args.world_seeds) for name in worlds}
    rows = [
        [Path(name).name, f"{share:.3f}", verdict(share), f"{auc:.3f}"]
        for name, (share, auc) in (sets | simulated).items()
    ]
    print(format_markdown(["set", "contradicted", "verdict", "AUC within bands"], rows))
    groups = {"sets": sets} | ({"sets and worlds": sets | simulated} if simulated else {})
    for what, found in groups.items():
        if len(found) > 2:
            correlation = spearmanr(list(found.values())).statistic
            print(f"rank correlation over {len(found)} {what}: {correlation:.2f}")
    if args.plot:
        draw({"recorded and embedded sets": sets, "simulated worlds": simulated}, args.plot)


def figures(out: Path, name: str, seeds: int) -> tuple[float, float]:
    """Share contradicted on training frames, and AUC within bands on test frames; means over the seeds."""
    store = store_of(name)
    train = split_recording(store.recording, "labelled-out").train
    nets = [trained_net(out / VARIANT, name, seed) for seed in range(seeds)]
    shares = [evidence_of(net, store, train)["self_assessment"]["contradicted"] for net in nets]
    aucs = [measured(out, VARIANT, name, seed)["entropy"][1] for seed in range(seeds)]
    return fmean(shares), fmean(aucs)


def draw(groups: dict[str, dict[str, tuple[float, float]]], path: Path) -> None:
    """One mark a set, and the limits of the verdicts."""
    figure, axes = plt.subplots(figsize=(7, 4.5))
    for label, found in groups.items():
        if found:
            axes.scatter(*zip(*found.values(), strict=True), label=label)
        for name, place in found.items():
            axes.annotate(Path(name).name, place, xytext=(4, 4), textcoords="offset points", fontsize=7)
    for limit, word in ((DOUBTFUL, "doubtful"), (NOT_TO_BE_TRUSTED, "not to be trusted")):
        axes.axvline(limit, color="grey", linewidth=0.8)
        axes.annotate(word, (limit, 0.45), xytext=(3, 0), textcoords="offset points", rotation=90, fontsize=7)
    axes.set_xlabel("share of the ground that is sure floor to the net and contradicted")
    axes.set_ylabel("AUC of the entropy within depression bands")
    axes.legend(loc="center right", fontsize=8)
    figure.savefig(path, bbox_inches="tight")


if __name__ == "__main__":
    main()
