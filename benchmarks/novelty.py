"""Does uncertainty tell what was never seen? Frames of another set among held-out frames of one's own."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
import torch
from nets import set_names, store_of, trained_net
from numpy.typing import NDArray
from places import AS_SHIPPED, EVERYWHERE, drawn_samples

from horizon_dl.data.evenly import evenly
from horizon_dl.data.view import View
from horizon_dl.evaluation.compare import split_recording
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.models.encoded import image_tensor
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.reporting.table import format_markdown
from horizon_dl.uncertainty.measures import measures

MEASURES = ("mutual_information", "entropy", "expected_entropy")
SAMPLES = 16
MOST_FRAMES = 24
Map = NDArray[np.float32]


def novelty_figures(name: str, seeds: Sequence[int], folder: Path) -> list[dict[str, Any]]:
    """AUC of 'a frame (a pixel) of the other set', by other set, place of the dropout and measure."""
    return [_of_seed(name, seed, folder) for seed in seeds]


def _of_seed(name: str, seed: int, folder: Path) -> dict[str, Any]:
    store = store_of(name)
    train = split_recording(store.recording, "labelled-out").train
    held_out = sorted(set(range(store.recording.length)) - set(train))
    own = list(store.views(evenly(held_out, MOST_FRAMES)))
    nets = {place: trained_net(folder, name, seed, place=place) for place in (AS_SHIPPED, EVERYWHERE)}
    torch.manual_seed(seed)
    own_maps = {place: list(_measured(net, place, own)) for place, net in nets.items()}
    found: dict[str, Any] = {}
    for other in set_names():
        if other != name:
            others = _views_of(other)
            found[other] = {
                place: _aucs(own_maps[place], list(_measured(net, place, others)))
                for place, net in nets.items()
            }
    return found


def _views_of(name: str) -> list[View]:
    store = store_of(name)
    return list(store.views(evenly(range(store.recording.length), MOST_FRAMES)))


def _measured(net: HorizonFCN, place: str, views: list[View]) -> Iterator[dict[str, Map]]:
    for view in views:
        with torch.inference_mode():
            image = image_tensor(view.image)
            if place == AS_SHIPPED:
                samples = net.sample_logits(net.encode(image))[0].sigmoid()
            else:
                samples = drawn_samples(net, place, image, SAMPLES)
        found = measures(samples.numpy(), np.zeros(samples.shape[1:], bool))
        yield {measure: getattr(found, measure) for measure in MEASURES}


def _aucs(own: list[dict[str, Map]], other: list[dict[str, Map]]) -> dict[str, dict[str, float | None]]:
    return {
        measure: {
            "frame": _auc(
                [m[measure].mean(keepdims=True).ravel() for m in own],
                [m[measure].mean(keepdims=True).ravel() for m in other],
            ),
            "pixel": _auc([m[measure].ravel() for m in own], [m[measure].ravel() for m in other]),
        }
        for measure in MEASURES
    }


def _auc(own: list[Map], other: list[Map]) -> float | None:
    roc = RocAccumulator()
    for values, is_other in ((np.concatenate(own), False), (np.concatenate(other), True)):
        roc.update(values, np.full(len(values), is_other), np.zeros(len(values)))
    return roc.compute().auc


def novelty_markdown(found: dict[str, list[dict[str, Any]]]) -> str:
    """Frame / pixel AUC, mean over seeds and over all other sets; in brackets the frame's worst pair."""
    places = next(iter(next(iter(found.values()))[0].values()))
    rows = []
    for place in places:
        for measure in MEASURES:
            cells = [_cell(seeds, place, measure) for seeds in found.values()]
            rows.append([f"{measure.replace('_', ' ')}, {place}", *cells])
    return format_markdown(["measure, dropout", *(f"trained on {name}" for name in found)], rows)


def _cell(seeds: list[dict[str, Any]], place: str, measure: str) -> str:
    pairs = [[one[other][place][measure] for one in seeds] for other in seeds[0]]
    frame = [fmean(figures["frame"] for figures in pair) for pair in pairs]
    pixel = [fmean(figures["pixel"] for figures in pair) for pair in pairs]
    return f"{fmean(frame):.2f} ({min(frame):.2f}) / {fmean(pixel):.2f}"
