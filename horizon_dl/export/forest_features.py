"""The forest's features as tensor operations, equal to `models.features.pixel_features` nearly everywhere.

All is computed in float64 in the order of scikit-image and SciPy: trees jump at thresholds, and a local
binary pattern asks whether interpolated and central grey levels are equal.
"""

from collections.abc import Iterable
from functools import reduce
from math import pi

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812

from horizon_dl.models.features import LAWS_VECTORS, LBP_POINTS, LBP_RADIUS_PX

GREY = (0.2125, 0.7154, 0.0721)


class ForestFeatures(nn.Module):
    """Features of every pixel, in the order of `FEATURE_NAMES`.

    Args:
        size: (w, h) of the images.
        interleaved: images are (1, h, w, 3) uint8, else (1, 3, h, w) of whole grey levels.
    """

    def __init__(self, size: tuple[int, int], *, interleaved: bool) -> None:
        super().__init__()
        self.interleaved = interleaved
        self.pattern = UniformPattern(size)

    def forward(self, image: Tensor) -> Tensor:
        """(h * w, 13) float32."""
        planes = image[0].permute(2, 0, 1) if self.interleaved else image[0]
        planes = planes.double() * (1 / 255)
        grey = sum_of(planes[i] * weight for i, weight in enumerate(GREY)).float()
        maps = [*hue_saturation_value(planes), self.pattern(grey), *laws(grey)]
        return torch.stack([one.float() for one in maps]).flatten(1).T


def sum_of(terms: Iterable[Tensor]) -> Tensor:
    """Left to right, from the first on."""
    return reduce(torch.add, terms)


def hue_saturation_value(planes: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """(h, w) each in [0, 1], of (3, h, w) float64 in [0, 1]."""
    red, green, blue = planes[0], planes[1], planes[2]
    value = torch.maximum(torch.maximum(red, green), blue)
    delta = value - torch.minimum(torch.minimum(red, green), blue)
    grey = delta == 0
    divisor = torch.where(grey, torch.ones_like(delta), delta)
    sixths = torch.where(green == value, 2 + (blue - red) / divisor, (green - blue) / divisor)
    sixths = torch.where(blue == value, 4 + (red - green) / divisor, sixths)
    turns = sixths / 6
    turns = torch.where(turns < 0, turns + 1, turns)
    hue = torch.where(grey, torch.zeros_like(turns), turns)
    return hue, delta / torch.where(value == 0, torch.ones_like(value), value), value


def laws(grey: Tensor) -> list[Tensor]:
    """Nine (h, w) responses of an (h, w) float32 image, columns first, each direction rounded to float32."""
    vectors = list(LAWS_VECTORS.values())
    columns = [convolved(grey, vector, 0) for vector in vectors]
    return [convolved(column, vector, 1) for column in columns for vector in vectors]


def convolved(maps: Tensor, vector: tuple[float, ...], axis: int) -> Tensor:
    """Convolution of (h, w) with three numbers along an axis, borders mirrored."""
    margins = (0, 0, 1, 1) if axis == 0 else (1, 1, 0, 0)
    padded = F.pad(maps[None], margins, mode="replicate")[0].double()
    length = maps.shape[axis]
    terms = [padded.narrow(axis, 2 - i, length) * weight for i, weight in enumerate(vector) if weight]
    return sum_of(terms).float()


class UniformPattern(nn.Module):
    """Uniform local binary pattern of an (h, w) image in [0, 1], see `models.features.uniform_lbp`."""

    def __init__(self, size: tuple[int, int]) -> None:
        super().__init__()
        self.width, self.height = size
        angles = 2 * pi * np.arange(LBP_POINTS, dtype=np.float64) / LBP_POINTS
        self.down = np.round(-LBP_RADIUS_PX * np.sin(angles), 5)
        self.right = np.round(LBP_RADIUS_PX * np.cos(angles), 5)

    def forward(self, grey: Tensor) -> Tensor:
        """(h, w) float32: 0 to 24, or 25."""
        levels = (grey * 255.0).round().double()
        margin = (LBP_RADIUS_PX,) * 4
        padded = F.pad(levels, margin)
        brighter = [self._point(padded, i) >= levels for i in range(LBP_POINTS)]
        changes = [one != other for one, other in zip(brighter[1:], brighter, strict=False)]
        count = torch.stack(brighter).float().sum(dim=0)
        uniform = torch.stack(changes).float().sum(dim=0) <= 2
        return torch.where(uniform, count, torch.full_like(count, LBP_POINTS + 1.0))

    def _point(self, padded: Tensor, index: int) -> Tensor:
        wide = _between(padded, self.right[index], 1, self.width)
        return _between(wide, self.down[index], 0, self.height)


def _between(padded: Tensor, offset: float, axis: int, length: int) -> Tensor:
    """Interpolation at every pixel's place plus the offset; fractions as they come out at each place."""
    places = np.arange(length) + offset
    low, high = int(np.floor(offset)), int(np.ceil(offset))
    fraction = torch.from_numpy(places - np.floor(places)).reshape((-1, 1) if axis == 0 else (1, -1))
    first = padded.narrow(axis, LBP_RADIUS_PX + low, length)
    if low == high:
        return first
    second = padded.narrow(axis, LBP_RADIUS_PX + high, length)
    return (1 - fraction) * first + fraction * second
