"""What dropout buys: AUC, calibration and time by where it sits and how often it is drawn."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, median
from typing import Any

import numpy as np
import torch
from nets import scored, trained_net
from numpy.typing import NDArray
from places import AS_SHIPPED, EVERYWHERE, HEAD, PLACES, analytic_mean, drawn_samples, place_dropout
from torch import Tensor

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metrics import method_metrics
from horizon_dl.models.encoded import image_tensor
from horizon_dl.models.fcn import HorizonFCN, enlarge
from horizon_dl.reporting.table import format_markdown
from horizon_dl.uncertainty.measures import P_ABOVE, binary_entropy

COUNTS = (1, 4, 16, 64)


class Variant:
    """One way to get a mean `p_above` of a net, as a method; keeps its processor times."""

    def __init__(self, mean_p: Callable[[Tensor], Tensor]) -> None:
        self._mean_p = mean_p
        self.times_s: list[float] = []

    def score_maps(self, _: Frame, view: View) -> dict[str, NDArray[np.float32]]:
        """The entropy, with `p_above`."""
        start = time.process_time()
        with torch.inference_mode():
            coarse = self._mean_p(image_tensor(view.image))
            p_above = enlarge(coarse[None, None], view.image.shape[:2])[0, 0].numpy()
        entropy = binary_entropy(p_above)
        self.times_s.append(time.process_time() - start)
        return {P_ABOVE: p_above, "entropy": entropy}


@dataclass(frozen=True)
class Way:
    """A row of the table."""

    place: str
    trained: bool
    samples: str


def dropout_figures(name: str, seeds: Sequence[int], folder: Path) -> list[dict[str, Any]]:
    """Rows for one set: place, whether trained with it, samples, and figures as in `metrics.json`."""
    accumulators: dict[Way, list[MethodAccumulator]] = {}
    times: dict[Way, list[float]] = {}
    for seed in seeds:
        ways = _ways(name, seed, folder)
        methods = {str(number): variant for number, variant in enumerate(ways.values())}
        torch.manual_seed(seed)
        found = scored(name, methods)
        for way, (number, variant) in zip(ways, methods.items(), strict=True):
            accumulators.setdefault(way, []).append(found[number])
            times.setdefault(way, []).extend(variant.times_s)
    return [
        {
            **vars(way),
            **method_metrics(accumulators[way], "none")["scores"]["entropy"],
            **method_metrics(accumulators[way], "none")["calibration"],
            "ms": 1e3 * median(times[way]),
        }
        for way in accumulators
    ]


def _ways(name: str, seed: int, folder: Path) -> dict[Way, Variant]:
    shipped = trained_net(folder, name, seed)
    ways = {
        Way(AS_SHIPPED, True, "single pass"): Variant(_single(shipped)),
        Way(AS_SHIPPED, True, "analytic"): Variant(lambda image: analytic_mean(shipped, image)),
        Way(AS_SHIPPED, True, "16 fixed masks (default)"): Variant(
            lambda image: shipped.sample_logits(shipped.encode(image))[0].sigmoid().mean(dim=0)
        ),
    }
    for place in PLACES:
        ways |= _drawn(place_dropout(shipped, place), place, place == AS_SHIPPED)
    for place in (HEAD, EVERYWHERE):
        net = trained_net(folder, name, seed, place=place)
        ways[Way(place, True, "single pass")] = Variant(_single(net))
        ways |= _drawn(net, place, True)
    return ways


def _single(net: HorizonFCN) -> Callable[[Tensor], Tensor]:
    return lambda image: net.eval().judge(net.encode(image))[0, 0].sigmoid()


def _drawn(net: HorizonFCN, place: str, trained: bool) -> dict[Way, Variant]:
    def mean_of(count: int) -> Callable[[Tensor], Tensor]:
        return lambda image: drawn_samples(net, place, image, count).mean(dim=0)

    return {Way(place, trained, str(count)): Variant(mean_of(count)) for count in COUNTS}


def dropout_markdown(found: dict[str, list[dict[str, Any]]]) -> str:
    """Two tables with a column a set: AUC pooled / within with the time, and calibration."""
    ways = list(zip(*found.values(), strict=True))
    auc = [[_name(way[0]), *(_auc_cell(row) for row in way)] for way in ways]
    ece = [[_name(way[0]), *(f"{row['ece']:.3f}" for row in way)] for way in ways]
    timed = [[*cells, f"{fmean(row['ms'] for row in way):.0f}"] for cells, way in zip(auc, ways, strict=True)]
    return "\n\n".join(
        [
            "AUC of the entropy, pooled / within; median processor time a frame, one thread.",
            format_markdown(["dropout", *found, "ms"], timed),
            "Expected calibration error of `p_above` against the side of the horizon.",
            format_markdown(["dropout", *found], ece),
        ]
    )


def _auc_cell(row: dict[str, Any]) -> str:
    return f"{row['auc']:.3f} / {row['auc_within_depression']:.3f}"


def _name(row: dict[str, Any]) -> str:
    return f"{row['place']}{'' if row['trained'] else ', not trained with it'}: {row['samples']}"
