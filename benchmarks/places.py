"""Dropout at other places of the net than before its last layer, and samples from it."""

import copy
import math

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812  (torch's own name)

from horizon_dl.models.encoders import SmallEncoder
from horizon_dl.models.fcn import HorizonFCN, normalised

AS_SHIPPED, HEAD, EVERYWHERE = "last layer", "head", "everywhere"
PLACES = (AS_SHIPPED, HEAD, EVERYWHERE)
ENCODER_RATE = 0.1
"""Of the feature maps after every convolution; the rate before the last layer is the config's."""
CHUNK = 4


def place_dropout(net: HorizonFCN, place: str) -> HorizonFCN:
    """A copy of the net with more dropout of whole feature maps.

    `last layer`: none more. `head`: also before each head's 1x1 layer, at the rate before the last layer.
    `everywhere`: also after each convolution of the small encoder, on the branch that is added.
    """
    net = copy.deepcopy(net)
    if place == AS_SHIPPED:
        return net
    for head in net.heads():
        head.neck = nn.Sequential(nn.Dropout2d(head.dropout.p), *head.neck)
    if place == EVERYWHERE:
        assert isinstance(net.encoder, SmallEncoder)
        first, relu, second, relu2 = net.encoder.stem
        net.encoder.stem = nn.Sequential(
            first, relu, nn.Dropout2d(ENCODER_RATE), second, relu2, nn.Dropout2d(ENCODER_RATE)
        )
        net.encoder.blocks = nn.ModuleList(
            nn.Sequential(block, nn.Dropout2d(ENCODER_RATE)) for block in net.encoder.blocks
        )
    return net


@torch.inference_mode()
def drawn_samples(net: HorizonFCN, place: str, image: Tensor, count: int) -> Tensor:
    """`p_above` under `count` fresh draws of dropout, (count, h / s, w / s) of (1, 3, h, w) RGB in [0, 1].

    Only what lies behind the first dropout is computed more than once.
    """
    net.eval()
    if place == AS_SHIPPED:
        features = net.encode(image)
        rate = net.deep.dropout.p
        masks = torch.bernoulli(torch.full((count, features.shape[1], 1, 1), 1 - rate)) / (1 - rate)
        weight, bias = net.last_layer()
        return F.conv2d(features, masks * weight, bias.expand(count))[0].sigmoid()
    for module in net.modules():
        if isinstance(module, nn.Dropout2d):
            module.train()
    if place == HEAD:
        depths = net.encoder(normalised(image))
        parts = [
            _mean_logit(net, [part.expand(size, -1, -1, -1) for part in depths]) for size in _chunks(count)
        ]
    else:
        parts = [
            _mean_logit(net, net.encoder(normalised(image.expand(size, -1, -1, -1))))
            for size in _chunks(count)
        ]
    net.eval()
    return torch.cat(parts)[:, 0].sigmoid()


@torch.inference_mode()
def analytic_mean(net: HorizonFCN, image: Tensor) -> Tensor:
    """Mean `p_above` over all dropout masks before the last layer, (h / s, w / s), without drawing any.

    The logit is a sum of independent masked features: taken as Gaussian, with mean `w f + b` and variance
    `sum (w f)^2 r / (1 - r)`; the mean of its sigmoid by MacKay's probit approximation (The evidence
    framework applied to classification networks, 1992, eq. 10).
    """
    net.eval()
    features = net.encode(image)
    rate = net.deep.dropout.p
    weight, bias = net.last_layer()
    mean = F.conv2d(features, weight, bias)[0, 0]
    variance = F.conv2d(features**2, weight**2)[0, 0] * (rate / (1 - rate))
    return torch.sigmoid(mean / torch.sqrt(1.0 + math.pi / 8.0 * variance))


def _mean_logit(net: HorizonFCN, depths: list[Tensor]) -> Tensor:
    logits = [head(part) for head, part in zip(net.heads(), depths, strict=True)]
    return torch.stack(logits).mean(dim=0)


def _chunks(count: int) -> list[int]:
    return [min(CHUNK, count - start) for start in range(0, count, CHUNK)]
