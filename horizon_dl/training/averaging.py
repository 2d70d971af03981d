"""The moving average of a net's weights, which predicts more steadily than the last step's."""

from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel


def averaged(net: nn.Module, decay: float) -> AveragedModel:
    """An exponential moving average of all weights and batch statistics; `update_parameters` after each step.

    The first steps count less: after n steps the decay is at most (n + 1) / (n + 10).
    """

    def blend(average: Tensor, newest: Tensor, steps: Tensor | int) -> Tensor:
        count = int(steps)
        now = min(decay, (count + 1) / (count + 10))
        return average + (newest - average) * (1.0 - now)

    average = AveragedModel(net, avg_fn=blend, use_buffers=True)
    average.requires_grad_(False)
    return average
