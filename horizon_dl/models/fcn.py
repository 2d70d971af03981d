"""The small fully convolutional net."""

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812  (torch's own name)

STRIDE = 4


def conv_block(inputs: int, outputs: int, *, stride: int = 1, dilation: int = 1) -> nn.Sequential:
    """3x3 convolution, batch norm, ReLU; replicated borders, so that no pixel can tell where it lies."""
    return nn.Sequential(
        nn.Conv2d(
            inputs,
            outputs,
            3,
            stride=stride,
            padding=dilation,
            dilation=dilation,
            padding_mode="replicate",
            bias=False,
        ),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )


class HorizonFCN(nn.Module):
    """Probability (as a logit) that a pixel's appearance belongs above the horizon.

    `encode` is deterministic, `head` holds all the dropout: sampling repeats the head alone.

    Args:
        encoder: module from (N, 3, h, w) normalised RGB to (N, features, h / 4, w / 4).
        features: channels the encoder gives.
        dropout: rate of the two dropout layers of the head, in [0, 1).
    """

    def __init__(self, encoder: nn.Module, features: int, dropout: float) -> None:
        super().__init__()
        self.encoder = encoder
        self.head = nn.Sequential(
            nn.Dropout2d(dropout),
            nn.Conv2d(features, features, 1),
            nn.ReLU(inplace=True),
            nn.Dropout2d(dropout),
            nn.Conv2d(features, 1, 1),
        )

    def encode(self, image: Tensor) -> Tensor:
        """Features of (N, 3, h, w) RGB in [0, 1], at a quarter of the size."""
        features: Tensor = self.encoder((image - 0.5) / 0.25)
        return features

    def forward(self, image: Tensor) -> Tensor:
        """Logits (N, 1, h, w) of (N, 3, h, w) RGB in [0, 1]."""
        return enlarge(self.head(self.encode(image)), image.shape[-2:])


def enlarge(maps: Tensor, size: torch.Size | tuple[int, int]) -> Tensor:
    """Bilinear enlargement to (h, w), pixel centres at half integers of the coarse grid."""
    return F.interpolate(maps, size=tuple(size), mode="bilinear", align_corners=False)


def small_encoder(channels: int) -> tuple[nn.Module, int]:
    """Two strided and four dilated 3x3 convolutions; returns the module and its output channels."""
    wide = 2 * channels // 2 * 1
    layers = [conv_block(3, channels // 2, stride=2), conv_block(channels // 2, channels, stride=2)]
    layers += [conv_block(channels if d == 1 else wide, wide, dilation=d) for d in (1, 2, 4, 8)]
    return nn.Sequential(*layers), wide
