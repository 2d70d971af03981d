"""The Lightning shell around the net: loss, optimiser, schedule."""

from collections.abc import Iterator
from typing import Any

import lightning
import numpy as np
import torch
from torch import Tensor
from torch.nn import functional as F  # noqa: N812  (torch's own name)
from torch.utils.data import IterableDataset

from horizon_dl.config import TrainConfig
from horizon_dl.learning.averaging import averaged
from horizon_dl.learning.crops import Batch, draw_batch
from horizon_dl.learning.distributed import mean_of_processes, process_count, process_number
from horizon_dl.learning.store import FramePool
from horizon_dl.models.fcn import HorizonFCN


def horizon_loss(logits: Tensor, batch: Batch) -> Tensor:
    """Cross-entropy with the soft targets, nats, mean over the pixels that count and over the depths.

    With several processes the pixels of all of them are counted, so that the mean of their losses is the loss
    of one process with all their crops.

    Args:
        logits: (N, depths, h, w), as coarse as the net gives them; targets are averaged to that size.
        batch: targets and weights, (N, 1, H, W).
    """
    targets, weights = (
        F.interpolate(part, size=logits.shape[-2:], mode="area") for part in (batch.targets, batch.weights)
    )
    losses = F.binary_cross_entropy_with_logits(logits, targets.expand_as(logits), reduction="none")
    return (losses.mean(dim=1, keepdim=True) * weights).sum() / mean_of_processes(weights.sum()).clamp(
        min=1.0
    )


class HorizonModule(lightning.LightningModule):
    """Trains a `HorizonFCN` for a number of steps known beforehand; `average` is the result."""

    def __init__(self, net: HorizonFCN, config: TrainConfig, steps: int) -> None:
        super().__init__()
        self.net = net.requires_grad_(True)
        self.config = config
        self.steps = steps
        self.average = averaged(net, config.average_decay)

    def on_train_start(self) -> None:
        """Give every process dropout of its own."""
        if process_number():
            torch.manual_seed(torch.initial_seed() + process_number())

    def training_step(self, batch: Batch, _: int) -> Tensor:
        """Loss of one batch of crops."""
        loss = horizon_loss(self.net(batch.images), batch)
        self.log("loss", loss, prog_bar=True, sync_dist=True)
        return loss

    def on_train_batch_end(self, *_: Any) -> None:
        """Take the step into the average."""
        self.average.update_parameters(self.net)

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


class CropStream(IterableDataset[Batch]):
    """An endless stream of batches from a pool.

    Each process of several draws the batches of all, and takes its own part.
    """

    def __init__(self, pool: FramePool, config: TrainConfig, rng: np.random.Generator) -> None:
        self._pool = pool
        self._config = config
        self._rng = rng

    def __iter__(self) -> Iterator[Batch]:
        size, count, number = self._config.batch, process_count(), process_number()
        own = slice(number * size, (number + 1) * size)
        while True:
            frames = self._pool.draw(size * count)
            everything = draw_batch(frames, self._config.crop, self._rng, self._config.pastes)
            yield Batch(*(part[own] for part in everything))
