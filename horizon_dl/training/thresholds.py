"""Thresholds of a trained net's entropy, from its training frames; no obstacle label is used."""

from collections.abc import Sequence
from typing import NamedTuple

from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import simulated_net
from horizon_dl.training.evenly import evenly
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.uncertainty.measures import binary_entropy
from horizon_dl.uncertainty.taught_threshold import TaughtThreshold
from horizon_dl.uncertainty.threshold import MOST_FRAMES, PaperThreshold


class Thresholds(NamedTuple):
    """Of the entropy, bits.

    Attributes:
        paper: a percentile, see `PaperThreshold`.
        simulated: see `TaughtThreshold`, the teacher being the net of the simulated worlds.
    """

    paper: float
    simulated: float | None


def thresholds_of(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> Thresholds:
    """Both thresholds of a net, over at most 50 of its training frames."""
    config = store.config
    teacher = simulated_net()
    paper, taught = PaperThreshold(config.threshold.percentile), TaughtThreshold()
    for view in store.views(evenly(indices, MOST_FRAMES)):
        entropy = binary_entropy(EncodedImage(net, view.image).p_above())
        paper.update(entropy, labelled_pixels(view.elevation, config.labels.band_rad))
        below = view.elevation < -config.labels.band_rad
        taught.update(entropy[below], EncodedImage(teacher, view.image).of_all_depths()[below])
    return Thresholds(paper.compute(), taught.compute())
