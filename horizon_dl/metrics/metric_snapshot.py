"""A metric as a part of a checkpoint."""

import torch

from horizon_dl.metrics.metric import Metric
from horizon_dl.training.checkpoint import Snapshot


def metric_snapshot(metric: Metric) -> Snapshot:
    """All that a metric has counted."""
    return Snapshot({name: torch.from_numpy(array) for name, array in metric.state().items()})


def restore_metric(metric: Metric, snapshot: Snapshot) -> None:
    """Go on from a snapshot."""
    metric.load({name: tensor.numpy().copy() for name, tensor in snapshot.tensors.items()})
