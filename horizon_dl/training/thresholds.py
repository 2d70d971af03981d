"""The paper's threshold of a trained net's entropy, from its training frames."""

from collections.abc import Sequence

from horizon_dl.data.evenly import evenly
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.uncertainty.measures import binary_entropy
from horizon_dl.uncertainty.threshold import MOST_FRAMES, paper_threshold


def paper_threshold_of(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> float:
    """See `PaperThreshold`: bits, over at most 50 of a net's training frames; no obstacle label is used."""
    config = store.config
    frames = (
        (
            binary_entropy(EncodedImage(net, view.image).p_above()),
            labelled_pixels(view.elevation, config.labels.band_rad),
        )
        for view in store.views(evenly(indices, MOST_FRAMES))
    )
    return paper_threshold(frames, config.threshold.percentile)
