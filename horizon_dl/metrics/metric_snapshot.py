"""A metric as a part of a checkpoint."""

import math

import numpy as np
import torch

from horizon_dl.metrics.metric import Metric
from horizon_dl.training.checkpoint import Snapshot


def metric_snapshot(metric: Metric) -> Snapshot:
    """All that a metric has counted: arrays as tensors, single numbers, as times are, as values."""
    state = metric.state()
    tensors = {name: torch.from_numpy(array) for name, array in state.items() if array.ndim}
    numbers = {name: array.item() for name, array in state.items() if not array.ndim}
    return Snapshot(tensors, {name: None if math.isnan(one) else one for name, one in numbers.items()})


def restore_metric(metric: Metric, snapshot: Snapshot) -> None:
    """Go on from a snapshot."""
    arrays = {name: tensor.numpy().copy() for name, tensor in snapshot.tensors.items()}
    numbers = {name: np.array(np.nan if one is None else one) for name, one in snapshot.values.items()}
    metric.load({**arrays, **numbers})
