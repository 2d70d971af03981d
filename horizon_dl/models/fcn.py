"""The small fully convolutional net."""

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812  (torch's own name)

MASK_SEED = 0


def conv_block(inputs: int, outputs: int, *, stride: int = 1, dilation: int = 1) -> nn.Sequential:
    """3x3 convolution, batch norm, ReLU; replicated borders, so that no pixel can tell where it lies."""
    convolution = nn.Conv2d(
        inputs,
        outputs,
        3,
        stride=stride,
        padding=dilation,
        dilation=dilation,
        padding_mode="replicate",
        bias=False,
    )
    return nn.Sequential(convolution, nn.BatchNorm2d(outputs), nn.ReLU(inplace=True))


class HorizonFCN(nn.Module):
    """Probability (as a logit) that a pixel's appearance belongs above the horizon.

    Dropout of whole feature maps sits before the last 1x1 convolution alone, so N samples of the output cost
    one 1x1 convolution with N outputs (`sample_logits`). The masks of those samples are drawn once, when the
    net is made, and kept with its weights: whoever runs the net, in whatever runtime, gets the same numbers.

    Args:
        encoder: module from (N, 3, h, w) normalised RGB to (N, features, h / s, w / s).
        features: channels the encoder gives.
        dropout: rate, in [0, 1).
        samples: number of fixed masks.
    """

    masks: Tensor

    def __init__(self, encoder: nn.Module, features: int, dropout: float, samples: int) -> None:
        super().__init__()
        self.encoder = encoder
        self.dropout = nn.Dropout2d(dropout)
        self.classifier = nn.Conv2d(features, 1, 1)
        self.register_buffer("masks", balanced_masks(samples, features, dropout))

    def encode(self, image: Tensor) -> Tensor:
        """Features (N, features, h / s, w / s) of (N, 3, h, w) RGB in [0, 1]; deterministic in eval mode."""
        features: Tensor = self.encoder((image - 0.5) / 0.25)
        return features

    def forward(self, image: Tensor) -> Tensor:
        """Logits (N, 1, h, w) of (N, 3, h, w) RGB in [0, 1]; in training mode under random dropout."""
        return enlarge(self.classifier(self.dropout(self.encode(image))), image.shape[-2:])

    def sample_logits(self, features: Tensor) -> Tensor:
        """Logits (N, samples, h / s, w / s) of encoded features, one channel a mask."""
        weight = self.masks[:, :, None, None] * self.classifier.weight
        assert self.classifier.bias is not None
        return F.conv2d(features, weight, self.classifier.bias.expand(len(weight)))


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


def small_encoder(channels: int) -> tuple[nn.Module, int]:
    """Two strided and four dilated 3x3 convolutions; returns the module and its output channels."""
    layers = [conv_block(3, channels // 2, stride=2), conv_block(channels // 2, channels, stride=2)]
    layers += [conv_block(channels, channels, dilation=dilation) for dilation in (1, 2, 4, 8)]
    return nn.Sequential(*layers), channels
