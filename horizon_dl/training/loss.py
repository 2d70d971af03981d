"""What the net is trained on; the same for all ways of training it."""

from torch import Tensor
from torch.nn import functional as F  # noqa: N812  (torch's own name)

from horizon_dl.training.crops import Batch
from horizon_dl.training.several_processes import mean_of_processes


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
