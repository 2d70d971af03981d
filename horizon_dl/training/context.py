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


def net_agreement(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> float | None:
    """Mean `path_agreement` of a net, by the heads at all its depths, on 16 of the frames; None for none."""
    return mean_agreement(
        path_agreement(view, EncodedImage(net, view.image).of_all_depths(), store.config.geodesic)
        for view in store.views(evenly(indices, AGREEMENT_FRAMES))
    )


def context_is_trusted(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> bool:
    """Whether a net agrees with the paths as well as the config asks for."""
    agreement = net_agreement(net, store, indices)
    return agreement is not None and agreement >= store.config.train.context_agreement


def with_context(config: Config) -> TrainConfig:
    """The settings of a round that learns from context."""
    train = config.train
    changed = {"batch": train.context_batch, "crop": train.context_crop, "pastes": 0}
    return train.model_copy(update=changed)
