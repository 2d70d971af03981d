"""The paper's own failure: the road in shade, before and after.

Shade is found without any label but the truth's floor: floor pixels darker than 0.6 of the median of all
floor pixels of their frame.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from ablations import ABLATIONS
from nets import store_of, trained_net
from numpy.typing import NDArray

from horizon_dl.data.evenly import evenly
from horizon_dl.data.frame import Frame
from horizon_dl.evaluation.compare import split_recording
from horizon_dl.evidence.sketch import LUMA
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.methods.learners import Method, NetMethod, fit_forest
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.metrics.scored_pixels import ScoredPixels, enlarged, scored_pixels
from horizon_dl.reporting.table import format_markdown
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.uncertainty.threshold import MOST_FRAMES, paper_threshold
from horizon_dl.workers import SerialWorkers

DARK = 0.6
WANTED_TPR = 0.9
NETS = {
    "hard labels (before)": ABLATIONS["hard labels"],
    "image edges only": ABLATIONS["geodesic, image edges only (one round)"],
    "default (after)": (),
}
PARTS = ("lit", "shade")
HEADER = (
    "method",
    "entropy lit / shade / obstacle",
    "FPR lit / shade, percentile 25",
    f"FPR lit / shade at TPR {WANTED_TPR}",
    "AUC within bands against lit / shade",
)


def shade_figures(name: str, seeds: Sequence[int], folder: Path) -> list[dict[str, Any]]:
    """Figures of the nets and the forest on the frames of a set that no learner has seen, one a seed."""
    return [_of_seed(name, seed, folder) for seed in seeds]


def _of_seed(name: str, seed: int, folder: Path) -> dict[str, Any]:
    store = store_of(name)
    train = split_recording(store.recording, "labelled-out").train
    methods: dict[str, Method] = {"forest": fit_forest(store, train, seed, SerialWorkers())}
    for title, overrides in NETS.items():
        methods[title] = NetMethod(trained_net(folder, name, seed, overrides))
    held_out = sorted(set(range(store.recording.length)) - set(train))
    return {title: _figures(method, store, train, held_out) for title, method in methods.items()}


def _figures(method: Method, store: FrameStore, train: Sequence[int], test: Sequence[int]) -> dict[str, Any]:
    values: dict[str, list[NDArray[np.float32]]] = {name: [] for name in (*PARTS, "obstacle")}
    rocs = {part: RocAccumulator() for part in PARTS}
    for frame, view in store.frames(test):
        entropy = enlarged(method.score_maps(frame, view)["entropy"], frame.image.shape[:2])
        pixels = scored_pixels(frame)
        values["obstacle"].append(entropy[pixels.mask][pixels.obstacle])
        for part, floor in zip(PARTS, lit_and_shaded(frame, pixels), strict=True):
            values[part].append(entropy[pixels.mask][floor])
            kept = pixels.keep(floor | pixels.obstacle)
            rocs[part].update(entropy[kept.mask], kept.obstacle, kept.depression_rad)
    pooled = {name: np.concatenate(parts) for name, parts in values.items()}
    rule = _percentile_threshold(method, store, train)
    at_tpr = float(np.quantile(pooled["obstacle"], 1.0 - WANTED_TPR))
    return {
        "pixels": {name: len(some) for name, some in pooled.items()},
        "mean_entropy": {name: float(some.mean()) for name, some in pooled.items()},
        "fpr": {part: float(np.mean(pooled[part] > rule)) for part in PARTS},
        "fpr_at_tpr": {part: float(np.mean(pooled[part] > at_tpr)) for part in PARTS},
        "auc_within_depression": {part: roc.compute().auc_within_depression for part, roc in rocs.items()},
        "auc": {part: roc.compute().auc for part, roc in rocs.items()},
    }


def lit_and_shaded(frame: Frame, pixels: ScoredPixels) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(n,) which of the scored pixels are floor in the light, and floor in shade."""
    luma = frame.image[pixels.mask] @ LUMA
    floor = ~pixels.obstacle
    dark = luma < DARK * np.median(luma[floor]) if floor.any() else np.zeros_like(floor)
    return floor & ~dark, floor & dark


def _percentile_threshold(method: Method, store: FrameStore, train: Sequence[int]) -> float:
    config = store.config
    entropies = (
        (
            method.score_maps(frame, view)["entropy"],
            labelled_pixels(view.elevation, config.labels.band_rad),
        )
        for frame, view in store.frames(evenly(train, MOST_FRAMES))
    )
    return paper_threshold(entropies, config.threshold.percentile)


def shade_markdown(found: dict[str, list[dict[str, Any]]]) -> str:
    """One table a set; figures are means over the seeds."""
    blocks = []
    for name, seeds in found.items():
        rows = [
            [
                title,
                _mean(seeds, title, "mean_entropy", (*PARTS, "obstacle")),
                *(_mean(seeds, title, key, PARTS) for key in ("fpr", "fpr_at_tpr", "auc_within_depression")),
            ]
            for title in seeds[0]
        ]
        counts = next(iter(seeds[0].values()))["pixels"]
        share = counts["shade"] / (counts["lit"] + counts["shade"])
        blocks.append(f"**{name}**, {share:.0%} of the floor in shade\n\n{format_markdown(HEADER, rows)}")
    return "\n\n".join(blocks)


def _mean(seeds: list[dict[str, Any]], title: str, key: str, parts: Sequence[str]) -> str:
    return " / ".join(f"{np.mean([one[title][key][part] for one in seeds]):.3f}" for part in parts)
