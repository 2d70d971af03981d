"""Thresholds of a trained net's entropy, from its training frames; no obstacle label is used."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import simulated_net
from horizon_dl.training.evenly import evenly
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.uncertainty.measures import binary_entropy
from horizon_dl.uncertainty.taught_threshold import taught_threshold
from horizon_dl.uncertainty.threshold import MOST_FRAMES, paper_threshold


def entropy_threshold(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> float:
    """The paper's threshold, bits: a percentile of the entropies of at most 50 training frames."""
    config = store.config
    frames = (
        (entropy_of(net, view.image), labelled_pixels(view.elevation, config.labels.band_rad))
        for view in store.views(evenly(indices, MOST_FRAMES))
    )
    return paper_threshold(frames, config.threshold.percentile)


def simulated_threshold(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> float | None:
    """See `taught_threshold`, bits: the teacher is the net of the simulated worlds; None without it."""
    teacher, band_rad = simulated_net(store.config.model), store.config.labels.band_rad
    if teacher is None:
        return None

    def frames() -> Iterator[tuple[NDArray[np.float32], NDArray[np.float32]]]:
        for view in store.views(evenly(indices, MOST_FRAMES)):
            below = view.elevation < -band_rad
            said = EncodedImage(teacher, view.image).of_all_depths()
            yield entropy_of(net, view.image)[below], said[below]

    return taught_threshold(frames())


def entropy_of(net: HorizonFCN, image: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Predictive entropy of an image, (h, w) bits."""
    return binary_entropy(EncodedImage(net, image).samples().mean(axis=0))
