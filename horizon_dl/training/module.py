"""The Lightning shell around the net: optimiser, schedule, crops."""

from collections.abc import Callable, Iterator
from typing import Any

import lightning
import numpy as np
import torch
from torch import Tensor
from torch.utils.data import IterableDataset

from horizon_dl.config import TrainConfig
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.training.averaging import averaged
from horizon_dl.training.crops import Batch, draw_batch
from horizon_dl.training.frame_store import FramePool
from horizon_dl.training.learning_state import learning_tensors, restore_learning
from horizon_dl.training.loss import horizon_loss
from horizon_dl.training.resumable import RoundState
from horizon_dl.training.several_processes import process_count, process_number


class HorizonModule(lightning.LightningModule):
    """Trains a `HorizonFCN` for a number of steps known beforehand; `average` is the result."""

    def __init__(
        self,
        net: HorizonFCN,
        config: TrainConfig,
        steps: int,
        *,
        done: int = 0,
        after_step: Callable[["HorizonModule"], None] | None = None,
        going_on: RoundState | None = None,
    ) -> None:
        """Take over a net.

        Args:
            net: to train.
            config: how.
            steps: of the round.
            done: steps of the rounds before, on which the logs go on.
            after_step: called after every step, when it has gone into the average.
            going_on: a state within the round, of `snapshot`.
        """
        super().__init__()
        self.net = net.requires_grad_(True)
        self.config = config
        self.steps, self._done = steps, done
        self.average = averaged(net, config.average_decay)
        self._after_step, self._going_on = after_step, going_on
        self._first = 0 if going_on is None else going_on.step

    @property
    def taken(self) -> int:
        """Steps taken in this round."""
        return self._first + self.global_step

    def snapshot(self) -> tuple[dict[str, Tensor], dict[str, Any]]:
        """Tensors and values to go on from after a step; tensors are shared, not copied."""
        optimiser = self.trainer.optimizers[0]
        schedule = self.trainer.lr_scheduler_configs[0].scheduler
        tensors = learning_tensors(self.net, self.average, optimiser, torch.get_rng_state())
        groups = optimiser.state_dict()["param_groups"]
        return tensors, {"optimiser": groups, "schedule": schedule.last_epoch}

    def on_train_start(self) -> None:
        """Give every process dropout of its own, or go on where a training was stopped."""
        if process_number():
            torch.manual_seed(torch.initial_seed() + process_number())
        if self._going_on is None:
            return
        state = self._going_on
        optimiser = self.trainer.optimizers[0]
        restore_learning(state.tensors, state.values["optimiser"], self.net, self.average, optimiser)
        schedule = self.trainer.lr_scheduler_configs[0].scheduler
        schedule.last_epoch = state.values["schedule"]

    def on_train_batch_start(self, *_: Any) -> None:
        """Dropout goes on where it was; what draws a random number before the first step has done so."""
        if self._going_on is not None:
            torch.set_rng_state(self._going_on.tensors["dropout"].cpu())
            self._going_on = None

    def training_step(self, batch: Batch, _: int) -> Tensor:
        """Loss of one batch of crops."""
        loss = horizon_loss(self.net(batch.images), batch)
        self.log("loss", loss, prog_bar=True, sync_dist=True)
        self.log("learning_rate", self.trainer.optimizers[0].param_groups[0]["lr"])
        self.log("step", float(self._done + self.taken))  # Lightning counts from 0 in every round
        return loss

    def on_train_batch_end(self, *_: Any) -> None:
        """Take the step into the average."""
        self.average.update_parameters(self.net)
        if self._after_step is not None:
            self._after_step(self)

    def configure_optimizers(self) -> Any:
        """AdamW; the learning rate rises for a tenth of the steps, then falls along a cosine."""
        optimiser = torch.optim.AdamW(
            self.net.parameters(), lr=self.config.learning_rate, weight_decay=self.config.weight_decay
        )
        # The schedule divides by the lengths of rise and fall: neither may be empty.
        steps = max(self.steps, 3)
        schedule = torch.optim.lr_scheduler.OneCycleLR(
            optimiser, self.config.learning_rate, total_steps=steps, pct_start=max(0.1, 2.0 / steps)
        )
        return {"optimizer": optimiser, "lr_scheduler": {"scheduler": schedule, "interval": "step"}}


DRAWN_AHEAD = 4
"""States that are kept: more than batches are ever drawn ahead."""


class CropStream(IterableDataset[Batch]):
    """An endless stream of batches from a pool.

    Each process of several draws the batches of all, and takes its own part.
    """

    def __init__(self, pool: FramePool, config: TrainConfig, rng: np.random.Generator) -> None:
        self._pool = pool
        self._config = config
        self._rng = rng
        self._drawn = 0
        self._before: dict[int, dict[str, Any]] = {}

    def random_state(self, drawn: int) -> dict[str, Any]:
        """Random numbers as they were after so many batches: later ones may be drawn ahead."""
        return self._before[drawn]

    def __iter__(self) -> Iterator[Batch]:
        size, count, number = self._config.batch, process_count(), process_number()
        own = slice(number * size, (number + 1) * size)
        while True:
            self._before[self._drawn] = dict(self._rng.bit_generator.state)
            self._before.pop(self._drawn - DRAWN_AHEAD, None)
            self._drawn += 1
            frames = self._pool.draw(size * count)
            everything = draw_batch(frames, self._config.crop, self._rng, self._config.pastes)
            yield Batch(*(part[own] for part in everything))
