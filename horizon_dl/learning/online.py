"""The online learner: frame in, prediction out, a few steps of learning, next frame."""

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.geometry.view import View
from horizon_dl.learning.crops import Batch, draw_batch, training_frame
from horizon_dl.learning.memory import ReplayMemory
from horizon_dl.learning.module import horizon_loss
from horizon_dl.models.build import build_net
from horizon_dl.uncertainty.dropout import sample_p_above, single_pass_p_above

Map = NDArray[np.float32]


class OnlineLearner:
    """A net that learns from a stream, in one pass.

    Example:
        >>> learner = OnlineLearner(Config())                       # doctest: +SKIP
        >>> for view in views:                                      # doctest: +SKIP
        ...     p_above = learner.p_above_samples(view).mean(0)
        ...     learner.learn(view)
    """

    def __init__(self, config: Config, seed: int = 0) -> None:
        self.config = config
        self._rng = np.random.default_rng(seed)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.net = build_net(config.model)
        self.memory = ReplayMemory(config.online.memory_mb, self._rng)
        self._optimiser = torch.optim.AdamW(
            self.net.parameters(), lr=config.online.learning_rate, weight_decay=config.train.weight_decay
        )

    def p_above_samples(self, view: View) -> Map:
        """`p_above` under each dropout mask, (samples, h, w) in [0, 1]."""
        return sample_p_above(self.net, view.image)

    def single_pass(self, view: View) -> Map:
        """`p_above` without dropout, (1, h, w) in [0, 1]."""
        return single_pass_p_above(self.net, view.image)

    def learn(self, view: View) -> float:
        """Learn from a frame and from remembered ones; returns the mean loss, nats.

        Half of every batch are crops of this frame, the other half of frames drawn from the memory.
        """
        newest = training_frame(view, self.config)
        self.memory.add(newest)
        settings = self.config.online
        losses = []
        for _ in range(settings.steps_per_frame):
            fresh = settings.batch // 2
            frames = [newest] * fresh + self.memory.draw(settings.batch - fresh)
            losses.append(self._step(draw_batch(frames, self.config.train.crop, self._rng)))
        return float(np.mean(losses))

    def _step(self, batch: Batch) -> float:
        self.net.train()
        loss = horizon_loss(self.net(batch.images), batch)
        self._optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self.net.parameters(), 1.0)
        self._optimiser.step()
        return float(loss.detach())
