"""The small fully convolutional net."""

from collections.abc import Sequence
from typing import cast

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812  (torch's own name)

MASK_SEED = 0


class Head(nn.Module):
    """A 1x1 layer, dropout of whole feature maps, and a linear classifier."""

    def __init__(self, channels: int, width: int, dropout: float) -> None:
        super().__init__()
        self.neck = nn.Sequential(nn.Conv2d(channels, width, 1), nn.ReLU(inplace=True))
        self.dropout = nn.Dropout2d(dropout)
        self.classifier = nn.Conv2d(width, 1, 1)

    def forward(self, features: Tensor) -> Tensor:
        """Logits (N, 1, h, w)."""
        logits: Tensor = self.classifier(self.dropout(self.neck(features)))
        return logits


class HorizonFCN(nn.Module):
    """Probability (as a logit) that a pixel's appearance belongs above the horizon.

    Every tapped depth of the encoder has a head, each with a loss of its own. The prediction is a weighted
    mean of their logits, at first the plain one: what sees much tells shade from a wall, but also the foot of
    a wall from its top, and is sure about both; what sees little cannot. The mean of all heads' probabilities
    guides the targets of later rounds.

    Dropout sits before the last layer alone, and a mean of linear layers is one linear layer of all their
    inputs, so the samples of the output cost one 1x1 convolution (`sample_logits`). Their masks are drawn
    once, when the net is made, and kept with its weights: whoever runs the net, in whatever runtime, gets the
    same numbers.

    Args:
        encoder: module from (N, 3, h, w) normalised RGB to features at the tapped depths, all of one size.
        channels: of the features at each depth.
        width: number of features that each head judges by.
        dropout: rate, in [0, 1).
        samples: number of fixed masks.
    """

    masks: Tensor
    head_weights: Tensor

    def __init__(
        self, encoder: nn.Module, channels: Sequence[int], width: int, dropout: float, samples: int
    ) -> None:
        super().__init__()
        self.encoder = encoder
        self.shallow = nn.ModuleList(Head(count, width, dropout) for count in channels[:-1])
        self.deep = Head(channels[-1], width, dropout)
        self.register_buffer("masks", balanced_masks(samples, width * len(channels), dropout))
        self.register_buffer("head_weights", torch.full((len(channels),), 1.0 / len(channels), device="cpu"))

    def weigh_deepest(self, share: float) -> None:
        """Give the deepest head a share of the prediction, in [0, 1]; the rest goes to the others alike."""
        others = len(self.head_weights) - 1
        self.head_weights.fill_((1.0 - share) / max(others, 1))
        self.head_weights[-1] = share if others else 1.0

    @property
    def deep_share(self) -> float:
        """What share of the prediction the deepest head has."""
        return float(self.head_weights[-1])

    def forward(self, image: Tensor) -> Tensor:
        """Logits (N, depths, h / s, w / s) of (N, 3, h, w) RGB in [0, 1], the deepest last."""
        features = self.encoder(normalised(image))
        return torch.cat([head(part) for head, part in zip(self.heads(), features, strict=True)], dim=1)

    def heads(self) -> list[Head]:
        """Those of all depths, the deepest last."""
        return [cast(Head, head) for head in (*self.shallow, self.deep)]

    def encode(self, image: Tensor) -> Tensor:
        """What all heads judge by, (N, features, h / s, w / s), of (N, 3, h, w) RGB in [0, 1]."""
        depths = self.encoder(normalised(image))
        return torch.cat([head.neck(part) for head, part in zip(self.heads(), depths, strict=True)], dim=1)

    def judge(self, features: Tensor) -> Tensor:
        """The logit (N, 1, h / s, w / s) of encoded features, without dropout."""
        return F.conv2d(features, *self.last_layer())

    def last_layer(self) -> tuple[Tensor, Tensor]:
        """Weight (1, features, 1, 1) and bias (1,) of the weighted mean of all heads' classifiers."""
        classifiers = [head.classifier for head in self.heads()]
        shares = list(zip(classifiers, self.head_weights, strict=True))
        weight = torch.cat([classifier.weight * share for classifier, share in shares], dim=1)
        bias = torch.stack([cast(Tensor, classifier.bias) * share for classifier, share in shares]).sum(dim=0)
        return weight, bias

    def sample_logits(self, features: Tensor) -> Tensor:
        """Logits (N, masks, h / s, w / s) of encoded features, one channel a mask."""
        weight, bias = self.sample_weights()
        return F.conv2d(features, weight, bias)

    def sample_weights(self) -> tuple[Tensor, Tensor]:
        """Weight (masks, features, 1, 1) and bias (masks,) of the convolution that samples."""
        weight, bias = self.last_layer()
        return self.masks[:, :, None, None] * weight, bias.expand(len(self.masks))


def normalised(image: Tensor) -> Tensor:
    """RGB in [0, 1] to about zero mean and unit deviation."""
    return (image - 0.45) * 4.0


def balanced_masks(samples: int, features: int, rate: float) -> Tensor:
    """Dropout masks (samples, features) in which every feature is dropped equally often.

    Each feature is dropped in `round(rate * samples)` of the masks, in which is random; what is kept is
    scaled so that every feature's mean over the masks is one. With so few masks this is closer to the limit
    of many than independent draws are: the mean logit is that of the pass without dropout.

    Example:
        >>> balanced_masks(4, 100, 0.5).mean(dim=0).unique().tolist()
        [1.0]
    """
    dropped = min(round(rate * samples), samples - 1)
    generator = torch.Generator().manual_seed(MASK_SEED)
    order = torch.rand(samples, features, generator=generator, device="cpu").argsort(dim=0)
    return (order >= dropped).float() * (samples / (samples - dropped))


def enlarge(maps: Tensor, size: torch.Size | tuple[int, int]) -> Tensor:
    """Bilinear enlargement to (h, w), pixel centres at half integers of the coarse grid."""
    return F.interpolate(maps, size=tuple(size), mode="bilinear", align_corners=False)
