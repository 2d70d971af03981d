"""How far net and paths agree while a stream is learned from.

It decides the heads' shares of the prediction and the simulated worlds' net's share of the targets. In rounds
that is done once, before the last (`training/context.py`); here both follow the latest answers.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.view import View
from horizon_dl.targets.agreement import mean_agreement, path_agreement
from horizon_dl.targets.geodesic_params import GeodesicParams
from horizon_dl.training.context import AGREEMENT_FRAMES

ASK_EVERY = 4
"""Frames; an answer takes about as long as a target. Picked on nothing."""


class RunningAgreement:
    """Mean `path_agreement` over the last 16 frames that were asked and said something.

    Args:
        params: what paths cost, and what is sure.
    """

    def __init__(self, params: GeodesicParams) -> None:
        self._params = params
        self._found: deque[float] = deque(maxlen=AGREEMENT_FRAMES)

    def ask(self, view: View, p_above: NDArray[np.float32]) -> float | None:
        """The mean after one frame more; None where no frame has said anything.

        Args:
            view: at the working size.
            p_above: (h, w) in [0, 1], what the heads at all depths say of it.
        """
        answer = path_agreement(view, p_above, self._params)
        if not np.isnan(answer):
            self._found.append(answer)
        return self.mean()

    def mean(self) -> float | None:
        """Of the answers at hand."""
        return mean_agreement(self._found)

    def state(self) -> list[float]:
        """The answers, the oldest first."""
        return list(self._found)

    def load(self, state: list[float]) -> None:
        """Take answers in place of those at hand."""
        self._found.clear()
        self._found.extend(state)
