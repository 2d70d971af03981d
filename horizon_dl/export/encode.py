"""The net up to its last layer, as it is deployed: from grey levels, with fewer passes through memory."""

from copy import deepcopy
from typing import cast

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812

from horizon_dl.models.encoders import SmallEncoder
from horizon_dl.models.fcn import HorizonFCN, normalised


class Encode(nn.Module):
    """Features of an image of whole grey levels.

    The scaling of the grey levels is folded into the small encoder's first layer: its borders are
    replicated, so that changes nothing but rounding. Encoders with zero borders get scaled images.

    Args:
        net: trained, in evaluation mode.
        interleaved: images are (1, h, w, 3) uint8 as they come from a camera, else (1, 3, h, w) float.
    """

    def __init__(self, net: HorizonFCN, *, interleaved: bool) -> None:
        super().__init__()
        self.encoder = deepcopy(net.encoder)
        self.necks = nn.ModuleList(head.neck for head in net.heads())
        self.interleaved, self.folded = interleaved, isinstance(net.encoder, SmallEncoder)
        if isinstance(self.encoder, SmallEncoder):
            layer = Interleaved if interleaved else Planar
            self.encoder.stem[0] = layer(*folded_first_layer(self.encoder))

    def forward(self, image: Tensor) -> Tensor:
        """(1, features, h / s, w / s)."""
        if not self.folded:
            planes = image.permute(0, 3, 1, 2) if self.interleaved else image
            image = normalised(planes / 255.0)
        depths = self.encoder(image)
        return torch.cat([neck(part) for neck, part in zip(self.necks, depths, strict=True)], dim=1)


def folded_first_layer(encoder: SmallEncoder) -> tuple[Tensor, Tensor]:
    """Weight and bias of the first convolution with its batch norm and the scaling of grey levels inside."""
    convolution, norm = cast(nn.Sequential, encoder.stem[0])
    if not (isinstance(convolution, nn.Conv2d) and isinstance(norm, nn.BatchNorm2d)):
        raise TypeError("the encoder does not begin with a convolution and its batch norm")
    if norm.running_mean is None or norm.running_var is None:
        raise TypeError("the first batch norm keeps no statistics")
    offset = normalised(torch.zeros(1, dtype=torch.float64))
    scale = (normalised(torch.ones(1, dtype=torch.float64)) - offset) / 255
    gain = norm.weight.double() / (norm.running_var.double() + norm.eps).sqrt()
    weight = convolution.weight.double() * gain[:, None, None, None]
    bias = norm.bias.double() - norm.running_mean.double() * gain + weight.sum(dim=(1, 2, 3)) * offset
    return (weight * scale).float().detach(), bias.float().detach()


class Planar(nn.Module):
    """3x3 convolution with stride 2 and replicated borders of (1, 3, h, w)."""

    weight: Tensor
    bias: Tensor

    def __init__(self, weight: Tensor, bias: Tensor) -> None:
        super().__init__()
        self.register_buffer("weight", weight)
        self.register_buffer("bias", bias)

    def forward(self, image: Tensor) -> Tensor:
        """(1, outputs, h / 2, w / 2) of float grey levels."""
        return F.conv2d(F.pad(image, (1, 1, 1, 1), mode="replicate"), self.weight, self.bias, stride=2)


class Interleaved(nn.Module):
    """The same of (1, h, w, 3) uint8, without sorting the colours into planes.

    Three colours side by side are a picture three times as wide, of which every output takes nine columns,
    six further on each time. Borders are replicated while a pixel is three bytes.
    """

    weight: Tensor
    bias: Tensor

    def __init__(self, weight: Tensor, bias: Tensor) -> None:
        super().__init__()
        outputs = weight.shape[0]
        self.register_buffer("weight", weight.permute(0, 2, 3, 1).reshape(outputs, 1, 3, 9).contiguous())
        self.register_buffer("bias", bias)

    def forward(self, image: Tensor) -> Tensor:
        """(1, outputs, h / 2, w / 2)."""
        height, width, colours = (int(length) for length in image.shape[1:])
        padded = F.pad(image[None], (0, 0, 1, width % 2, 1, height % 2), mode="replicate")
        wide = padded.reshape(1, 1, -1, (1 + width + width % 2) * colours)
        return F.conv2d(wide.float(), self.weight, self.bias, stride=(2, 6))
