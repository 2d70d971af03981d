"""The online learner: frame in, prediction out, a few steps of learning, next frame."""

from typing import cast

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.geometry.view import View
from horizon_dl.learning.averaging import averaged
from horizon_dl.learning.crops import Batch, TrainingFrame, draw_batch, training_frame
from horizon_dl.learning.memory import ReplayMemory
from horizon_dl.learning.module import horizon_loss
from horizon_dl.models.build import build_net
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.uncertainty.dropout import p_above_of_all_depths, sample_p_above, single_pass_p_above

Map = NDArray[np.float32]

NEWEST_CROPS = 1
"""Crops of the newest frame in every batch; the others come from the memory."""
FIRST_GUIDED_FRAME = 10
"""From this frame on the targets also follow the edges in what the net has learned."""


class OnlineLearner:
    """A net that learns from a stream, in one pass; the moving average of its weights predicts.

    Example:
        >>> learner = OnlineLearner(Config())                       # doctest: +SKIP
        >>> for view in views:                                      # doctest: +SKIP
        ...     p_above = learner.p_above_samples(view).mean(0)
        ...     learner.learn(view)
    """

    def __init__(self, config: Config, seed: int = 0) -> None:
        self.config = config
        self.frames = 0
        self._rng = np.random.default_rng(seed)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self._net = build_net(config.model)
            self._dropout_state = torch.get_rng_state()
        self._average = averaged(self._net, config.train.average_decay)
        self.memory = ReplayMemory(config.online.memory_mb, self._rng)
        self._optimiser = torch.optim.AdamW(
            self._net.parameters(), lr=config.online.learning_rate, weight_decay=config.train.weight_decay
        )

    @property
    def net(self) -> HorizonFCN:
        """The net that predicts."""
        return cast(HorizonFCN, self._average.module)

    def p_above_samples(self, view: View) -> Map:
        """`p_above` under each dropout mask, (samples, h, w) in [0, 1]."""
        return sample_p_above(self.net, view.image)

    def single_pass(self, view: View) -> Map:
        """`p_above` without dropout, (1, h, w) in [0, 1]."""
        return single_pass_p_above(self.net, view.image)

    def learn(self, view: View) -> float:
        """Learn from a frame and from remembered ones; returns the mean loss, nats."""
        newest = self._training_frame(view)
        self.memory.add(newest)
        settings = self.config.online
        early = self.frames < settings.warm_up_frames
        self.frames += 1
        steps = settings.warm_up_steps if early else settings.steps_per_frame
        with torch.random.fork_rng(devices=[]):
            torch.set_rng_state(self._dropout_state)
            losses = [self._step(self._batch(newest)) for _ in range(steps)]
            self._dropout_state = torch.get_rng_state()
        return float(np.mean(losses))

    def _training_frame(self, view: View) -> TrainingFrame:
        guided = self.frames >= FIRST_GUIDED_FRAME
        return training_frame(
            view, self.config, p_above_of_all_depths(self.net, view.image) if guided else None
        )

    def _batch(self, newest: TrainingFrame) -> Batch:
        remembered = self.memory.draw(self.config.online.batch - NEWEST_CROPS)
        return draw_batch([newest] * NEWEST_CROPS + remembered, self.config.train.crop, self._rng)

    def _step(self, batch: Batch) -> float:
        self._net.train()
        loss = horizon_loss(self._net(batch.images), batch)
        self._optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self._net.parameters(), 1.0)
        self._optimiser.step()
        self._average.update_parameters(self._net)
        return float(loss.detach())
