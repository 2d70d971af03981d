"""Encoders: from an image to features at several depths, all a quarter or an eighth of its size.

torchvision is imported where it is used: it takes longer to load than all else together.
"""

from collections.abc import Sequence

from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812  (torch's own name)

# Picked on arena, corridor, hallway and KITTI (docs/RESEARCH.md): expect less elsewhere.
DILATIONS = (1, 2, 4, 8)
TAPPED = (1, 3)
"""Of the blocks: after dilation 2 a pixel sees 35 pixels around, after dilation 8 131."""


def convolution(inputs: int, outputs: int, *, stride: int = 1, dilation: int = 1) -> nn.Sequential:
    """3x3 convolution and batch norm; replicated borders, so that no pixel can tell where it lies."""
    layer = nn.Conv2d(
        inputs,
        outputs,
        3,
        stride=stride,
        padding=dilation,
        dilation=dilation,
        padding_mode="replicate",
        bias=False,
    )
    return nn.Sequential(layer, nn.BatchNorm2d(outputs))


class SmallEncoder(nn.Module):
    """Two strided convolutions and four dilated residual blocks, tapped after the second and the fourth."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.stem = nn.Sequential(
            convolution(3, channels // 2, stride=2),
            nn.ReLU(inplace=True),
            convolution(channels // 2, channels, stride=2),
            nn.ReLU(inplace=True),
        )
        self.blocks = nn.ModuleList(convolution(channels, channels, dilation=d) for d in DILATIONS)

    def forward(self, image: Tensor) -> list[Tensor]:
        """Features (N, channels, h / 4, w / 4) at two depths."""
        x: Tensor = self.stem(image)
        depths = []
        for block in self.blocks:
            x = F.relu(x + block(x))
            depths.append(x)
        return [depths[tap] for tap in TAPPED]


class StagedEncoder(nn.Module):
    """The first stages of a known network, tapped after each of the last ones.

    Args:
        first: modules up to the first tap.
        later: further modules, each tapped; none of them may change the size.
    """

    def __init__(self, first: nn.Module, later: Sequence[nn.Module]) -> None:
        super().__init__()
        self.first = first
        self.later = nn.ModuleList(later)

    def forward(self, image: Tensor) -> list[Tensor]:
        """Features at each tap, all of one size."""
        depths = [self.first(image)]
        for stage in self.later:
            depths.append(stage(depths[-1]))
        return depths


def small(channels: int) -> tuple[nn.Module, list[int]]:
    """The default encoder, and its channels at each tap."""
    return SmallEncoder(channels), [channels] * len(TAPPED)


def mobilenet(_: int) -> tuple[nn.Module, list[int]]:
    """MobileNetV3-Small up to an eighth of the size, from random weights: nothing is downloaded."""
    from torchvision.models import mobilenet_v3_small

    stages = mobilenet_v3_small(weights=None).features
    return StagedEncoder(stages[:3], [stages[3]]), [24, 24]


def resnet(_: int) -> tuple[nn.Module, list[int]]:
    """ResNet-18 up to a quarter of the size, from random weights."""
    from torchvision.models import resnet18

    net = resnet18(weights=None)
    stem = nn.Sequential(net.conv1, net.bn1, net.relu, net.maxpool)
    return StagedEncoder(nn.Sequential(stem, net.layer1[0]), [net.layer1[1]]), [64, 64]
