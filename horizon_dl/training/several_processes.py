"""Training in several processes that together do what one would do with all their crops."""

from typing import Any

import torch
from torch import Tensor, distributed

from horizon_dl.config import TrainerConfig


def processes_of(settings: TrainerConfig) -> int:
    """Processes that a trainer of these settings will have, before it has started them."""
    if settings.devices != "auto":
        return settings.devices * settings.num_nodes
    on_gpu = settings.accelerator in ("auto", "gpu", "cuda")
    return (max(torch.cuda.device_count(), 1) if on_gpu else 1) * settings.num_nodes


def process_count() -> int:
    """Processes that train together; 1 outside distributed training."""
    return distributed.get_world_size() if _several() else 1


def process_number() -> int:
    """Which of them this is, from 0."""
    return distributed.get_rank() if _several() else 0


def mean_of_processes(value: Tensor) -> Tensor:
    """The mean over all processes; gradients flow back to all of them."""
    if not _several():
        return value
    total: Tensor = _Sum.apply(value)  # type: ignore[no-untyped-call]
    return total / process_count()


def _several() -> bool:
    return distributed.is_available() and distributed.is_initialized() and distributed.get_world_size() > 1


class _Sum(torch.autograd.Function):
    """The sum over all processes; so is its gradient."""

    @staticmethod
    def forward(_: Any, value: Tensor) -> Tensor:
        total = value.clone()
        distributed.all_reduce(total)
        return total

    @staticmethod
    def backward(_: Any, gradient: Tensor) -> Tensor:
        total = gradient.clone().contiguous()
        distributed.all_reduce(total)
        return total
