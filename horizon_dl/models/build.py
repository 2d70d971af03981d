"""Nets by name."""

from torch import nn
from torchvision import models as torchvision_models

from horizon_dl.config import ModelConfig
from horizon_dl.models.fcn import HorizonFCN, small_encoder


def build_net(config: ModelConfig) -> HorizonFCN:
    """A net with fresh weights: the small one, or the first stages of a torchvision encoder.

    The torchvision encoders are cut where their stride exceeds 4 (ResNet) or 8 (MobileNet), since a large
    receptive field is of no use here; they start from random weights, nothing is downloaded.
    """
    encoder, features = _ENCODERS[config.kind](config.channels)
    return HorizonFCN(encoder, features, config.dropout, config.samples)


def parameter_count(net: nn.Module) -> int:
    """Number of learned parameters."""
    return sum(parameter.numel() for parameter in net.parameters())


def _mobilenet(_: int) -> tuple[nn.Module, int]:
    return torchvision_models.mobilenet_v3_small(weights=None).features[:4], 24


def _resnet(_: int) -> tuple[nn.Module, int]:
    net = torchvision_models.resnet18(weights=None)
    return nn.Sequential(net.conv1, net.bn1, net.relu, net.maxpool, net.layer1), 64


_ENCODERS = {"fcn": small_encoder, "mobilenet_v3_small": _mobilenet, "resnet18": _resnet}
