"""The small fully convolutional net."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812  (torch's own name)

MASK_SEED = 0


class HorizonFCN(nn.Module):
    """Probability that a pixel's appearance belongs above the horizon, judged at several depths.

    Every depth of the encoder that is tapped has a classifier of its own, so that one judges by the nearest
    surroundings and another by a large part of the image; their probabilities are averaged. A classifier
    that sees much tells the foot of a wall from its top and is sure about both; one that sees little cannot.

    Dropout of whole feature maps sits before the last 1x1 convolution alone, so the samples of the output
    cost one 1x1 convolution (`sample_logits`). Their masks are drawn once, when the net is made, and kept
    with its weights: whoever runs the net, in whatever runtime, gets the same numbers.

    Args:
        encoder: module from (N, 3, h, w) normalised RGB to features at the tapped depths, all of one size.
        channels: of the features at each depth.
        width: features each classifier judges by.
        dropout: rate, in [0, 1).
        samples: number of fixed masks.
    """

    masks: Tensor

    def __init__(
        self, encoder: nn.Module, channels: Sequence[int], width: int, dropout: float, samples: int
    ) -> None:
        super().__init__()
        self.encoder = encoder
        self.necks = nn.ModuleList(
            nn.Sequential(nn.Conv2d(count, width, 1), nn.ReLU(inplace=True)) for count in channels
        )
        self.dropout = nn.Dropout2d(dropout)
        depths = len(channels)
        self.classifiers = nn.Conv2d(depths * width, depths, 1, groups=depths)
        self.register_buffer("masks", balanced_masks(samples, depths * width, dropout))

    def encode(self, image: Tensor) -> Tensor:
        """Features (N, depths * width, h / s, w / s) of (N, 3, h, w) RGB in [0, 1]; no dropout here."""
        features = self.encoder((image - 0.5) / 0.25)
        return torch.cat([neck(part) for neck, part in zip(self.necks, features, strict=True)], dim=1)

    def forward(self, image: Tensor) -> Tensor:
        """Logits (N, depths, h / s, w / s) of (N, 3, h, w) RGB in [0, 1]; in training mode with dropout."""
        logits: Tensor = self.classifiers(self.dropout(self.encode(image)))
        return logits

    def sample_logits(self, features: Tensor) -> Tensor:
        """Logits (N, depths * masks, h / s, w / s) of encoded features: every classifier, every mask."""
        weight, bias = self.sample_weights()
        return F.conv2d(features, weight, bias, groups=len(self.necks))

    def sample_weights(self) -> tuple[Tensor, Tensor]:
        """Weight (depths * masks, width, 1, 1) and bias of the grouped convolution that samples."""
        depths, masks = len(self.necks), len(self.masks)
        masked = self.masks.view(masks, depths, -1) * self.classifiers.weight[None, :, :, 0, 0]
        assert self.classifiers.bias is not None
        weight = masked.transpose(0, 1).reshape(depths * masks, -1, 1, 1)
        return weight, self.classifiers.bias.repeat_interleave(masks)


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
    order = torch.rand(samples, features, generator=generator).argsort(dim=0)
    return (order >= dropped).float() * (samples / (samples - dropped))


def enlarge(maps: Tensor, size: torch.Size | tuple[int, int]) -> Tensor:
    """Bilinear enlargement to (h, w), pixel centres at half integers of the coarse grid."""
    return F.interpolate(maps, size=tuple(size), mode="bilinear", align_corners=False)
