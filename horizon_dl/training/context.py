"""Whether the last round may learn from context, decided without a label.

What surrounds a pixel tells shade from a wall, but also where in the scene a pixel lies, and then a desk is
floor as it lies where floor does. So rounds learn from small crops with pieces of others pasted in. Where the
net so far and the paths through the image agree on what is obstacle (`targets/agreement.py`) things differ
from the floor in appearance, and context only helps.
"""

from collections.abc import Sequence

from horizon_dl.config import Config, TrainConfig
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.targets.agreement import mean_agreement, path_agreement
from horizon_dl.training.evenly import evenly
from horizon_dl.training.frame_store import FrameStore

AGREEMENT_FRAMES = 16
NO_CONTEXT, ALL_CONTEXT = 0.45, 0.8
"""Agreements between which the deepest head's share grows from none to all. Picked on eight sets (mean within
bands .769 to .777); on sixteen simulated worlds, on which they were not picked, they change nothing."""


def net_agreement(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> float | None:
    """Mean `path_agreement` of a net, by the heads at all its depths, on 16 of the frames; None for none."""
    return mean_agreement(
        path_agreement(view, EncodedImage(net, view.image).of_all_depths(), store.config.geodesic)
        for view in store.views(evenly(indices, AGREEMENT_FRAMES))
    )


def deep_share(agreement: float | None) -> float:
    """What share of the prediction the head that sees most gets; the mean of all where nothing is known.

    Example:
        >>> deep_share(0.3), deep_share(0.625), deep_share(0.9), deep_share(None)
        (0.0, 0.5, 1.0, 0.5)
    """
    if agreement is None:
        return 0.5
    return min(max((agreement - NO_CONTEXT) / (ALL_CONTEXT - NO_CONTEXT), 0.0), 1.0)


def with_context(config: Config) -> TrainConfig:
    """The settings of a round that learns from context."""
    train = config.train
    changed = {"batch": train.context_batch, "crop": train.context_crop, "pastes": 0}
    return train.model_copy(update=changed)
