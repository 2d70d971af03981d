"""What the last round learns from, decided without a label by how far net and paths agree.

What surrounds a pixel tells shade from a wall, but also where in the scene a pixel lies, and then a desk is
floor as it lies where floor does. So rounds learn from small crops with pieces of others pasted in. Where the
net so far and the paths through the image agree on what is obstacle (`targets/agreement.py`) things differ
from the floor in appearance, and context only helps. Where they do not, paths are no guide to the truth: then
the targets also follow the net that was taught in simulated worlds (`models/start.py`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.config import Config, TrainConfig
from horizon_dl.data.evenly import evenly
from horizon_dl.data.view import View
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import starts_simulated
from horizon_dl.targets.agreement import mean_agreement, path_agreement
from horizon_dl.targets.targets import LEARNING
from horizon_dl.training.frame_store import FrameStore

Map = NDArray[np.float32]

AGREEMENT_FRAMES = 16
LEAST_STEPS = 100
"""A net of fewer steps knows too little to be asked: on KITTI one of 60 agreed by .47, though the deepest
head was by far the best; one of 120 by .74."""
LEAST_FRAMES = 100
"""Of a round, however short: with 56 and 37 the room was worse (docs/RESEARCH.md)."""
NO_CONTEXT, ALL_CONTEXT = 0.45, 0.8
"""Agreements between which the deepest head's share grows from none to all. Picked on eight sets (mean within
bands .769 to .777); on sixteen simulated worlds, on which they were not picked, they change nothing."""


@dataclass(frozen=True)
class RoundPlan:
    """What a round learns from.

    Attributes:
        settings: with its batch, crops and pieces.
        taught: share of the simulated worlds' net in the targets below the horizon, in [0, 1].
    """

    settings: TrainConfig
    taught: float = 0.0

    def frames(self, steps: int, processes: int = 1) -> int:
        """How many frames are enough: a hundred, or so many that each gives `crops_per_frame` crops.

        Making a frame's target takes as long as learning from five of its crops, and frames that follow each
        other show much the same: a long recording takes no longer than a short one.

        Args:
            steps: of the round.
            processes: that train together; each draws a batch a step.
        """
        batch = self.settings.batch * processes
        return max(LEAST_FRAMES, batch, steps * batch // self.settings.crops_per_frame)


def agreement_of(learner: Callable[[View], Map], store: FrameStore, indices: Sequence[int]) -> float | None:
    """Mean `path_agreement` of what a learner says of a view, on 16 of the frames; None for none."""
    return mean_agreement(
        path_agreement(view, learner(view), store.config.geodesic)
        for view in store.views(evenly(indices, AGREEMENT_FRAMES))
    )


def all_depths(net: HorizonFCN) -> Callable[[View], Map]:
    """What the heads at all depths of a net say of a view: what its agreement is asked of."""
    return lambda view: EncodedImage(net, view.image).of_all_depths()


def share_of_deepest(agreement: float) -> float:
    """What share of the prediction the head that sees most gets.

    Example:
        >>> share_of_deepest(0.3), share_of_deepest(0.625), share_of_deepest(0.9)
        (0.0, 0.5, 1.0)
    """
    return min(max((agreement - NO_CONTEXT) / (ALL_CONTEXT - NO_CONTEXT), 0.0), 1.0)


def before_last_round(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> RoundPlan:
    """Decide by a net's agreement what the last round learns from.

    Args:
        net: after all rounds but the last; its heads get their shares of the prediction.
        store: where its frames come from.
        indices: which of them.
    """
    train = store.config.train
    agreement = agreement_of(all_depths(net), store, indices) if _is_to_be_asked(train) else None
    if agreement is None:
        return RoundPlan(train)
    if agreement < train.context_agreement:
        share = share_of_deepest(agreement)
        net.weigh_deepest(share)
        return RoundPlan(train, taught_share(store.config, share))
    net.weigh_deepest(1.0)
    changed = {"batch": train.context_batch, "crop": train.context_crop, "pastes": 0}
    return RoundPlan(train.model_copy(update=changed))


def taught_share(config: Config, deepest: float) -> float:
    """The simulated worlds' net's share of the targets, by the deepest head's share of the prediction.

    Only targets that follow a net have a teacher: hard labels stay hard.
    """
    has_one = config.target.kind in LEARNING and starts_simulated(config.model)
    return config.train.simulated_share * (1.0 - deepest) if has_one else 0.0


def _is_to_be_asked(train: TrainConfig) -> bool:
    done = train.rounds[:-1]
    return len(done) > 0 and sum(done) >= LEAST_STEPS
