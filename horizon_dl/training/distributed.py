"""Batch norm over the crops of all processes that train together."""

import torch
from lightning.pytorch.plugins import LayerSync
from torch import Tensor, nn

from horizon_dl.training.several_processes import mean_of_processes, process_count


class GlobalBatchNorm2d(nn.BatchNorm2d):
    """Batch norm with the statistics of all processes' crops.

    As `torch.nn.SyncBatchNorm`, which does not run on CPUs.
    """

    def forward(self, features: Tensor) -> Tensor:
        """(N, c, h, w) to the same, normalised while training by the mean and variance of all processes."""
        if not (self.training and process_count() > 1):
            alone: Tensor = super().forward(features)
            return alone
        mean, square = mean_of_processes(
            torch.stack([features.mean(dim=(0, 2, 3)), features.square().mean(dim=(0, 2, 3))])
        )
        variance = (square - mean.square()).clamp(min=0.0)  # rounding may leave it below
        self._remember(mean.detach(), variance.detach(), process_count() * features[:, 0].numel())
        scale: Tensor = self.weight * torch.rsqrt(variance + self.eps)
        normalised: Tensor = (features - mean[:, None, None]) * scale[:, None, None] + self.bias[
            :, None, None
        ]
        return normalised

    def _remember(self, mean: Tensor, variance: Tensor, count: int) -> None:
        if self.running_mean is None or self.running_var is None or self.num_batches_tracked is None:
            return  # made without running statistics
        share = 0.1 if self.momentum is None else self.momentum
        self.running_mean.lerp_(mean, share)
        self.running_var.lerp_(variance * (count / max(count - 1, 1)), share)
        self.num_batches_tracked.add_(1)


class SyncBatchNorm(LayerSync):
    """Lightning's way to have every batch norm of a net work on all processes' crops."""

    def apply(self, model: nn.Module) -> nn.Module:
        """Exchange the class; parameters, statistics and their names stay what they are."""
        return _exchanged(model, nn.BatchNorm2d, GlobalBatchNorm2d)

    def revert(self, model: nn.Module) -> nn.Module:
        """Undo `apply`."""
        return _exchanged(model, GlobalBatchNorm2d, nn.BatchNorm2d)


def _exchanged(model: nn.Module, old: type[nn.Module], new: type[nn.Module]) -> nn.Module:
    for module in model.modules():
        if type(module) is old:
            module.__class__ = new
    return model
