"""Where learning stands, as tensors by name for a checkpoint: net, moving average, optimiser and dropout."""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor, nn
from torch.optim import Optimizer


def learning_tensors(
    net: nn.Module, average: nn.Module, optimiser: Optimizer, dropout: Tensor
) -> dict[str, Tensor]:
    """All tensors that are needed to go on; they are shared, not copied.

    Args:
        net: that learns.
        average: of its weights.
        optimiser: its groups of parameters, `optimiser.state_dict()["param_groups"]`, are no tensors.
        dropout: state of the random numbers.
    """
    return {
        **{f"net.{name}": tensor for name, tensor in net.state_dict().items()},
        **{f"average.{name}": tensor for name, tensor in average.state_dict().items()},
        **{
            f"optimiser.{index}.{name}": torch.as_tensor(value)
            for index, one in optimiser.state_dict()["state"].items()
            for name, value in one.items()
        },
        "dropout": dropout,
    }


def restore_learning(
    tensors: Mapping[str, Tensor],
    param_groups: list[dict[str, Any]],
    net: nn.Module,
    average: nn.Module,
    optimiser: Optimizer,
) -> None:
    """Go on from `learning_tensors`; dropout is left to the caller, who knows when it is drawn next."""
    net.load_state_dict(starting(tensors, "net."))
    average.load_state_dict(starting(tensors, "average."))
    states: dict[int, dict[str, Tensor]] = {}
    for key, tensor in starting(tensors, "optimiser.").items():
        index, _, name = key.partition(".")
        states.setdefault(int(index), {})[name] = tensor
    optimiser.load_state_dict({"state": states, "param_groups": param_groups})


def starting(tensors: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    """Those whose names begin so, by their names without it.

    Example:
        >>> list(starting({"net.weight": torch.zeros(1), "dropout": torch.zeros(1)}, "net."))
        ['weight']
    """
    return {name.removeprefix(prefix): one for name, one in tensors.items() if name.startswith(prefix)}
