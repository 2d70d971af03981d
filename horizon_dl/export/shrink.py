"""Resizing inside the graph: area averaging before the net, nearest pixel for the obstacle map."""

from typing import Any

import torch
from torch import Tensor, nn

from horizon_dl.geometry.resize import area_weights

BAND = 48
"""Output pixels a matrix product; the weights are a narrow band, most of a whole matrix would be zeros."""


class AreaShrink(nn.Module):
    """`area_resize` of (1, H, W, 3) uint8 to (1, 3, h, w) float of whole grey levels, equal to the bit.

    Args:
        image_size: (W, H).
        size: (w, h), not larger.
    """

    def __init__(self, image_size: tuple[int, int], size: tuple[int, int]) -> None:
        super().__init__()
        self.image_size, self.size = image_size, size
        self.rows = Banded(image_size[1], size[1])
        self.columns = Banded(image_size[0], size[0])

    def forward(self, image: Tensor) -> Tensor:
        """Reduce; rows first, as `area_resize` does."""
        if self.image_size == self.size:
            return image.permute(0, 3, 1, 2).float()
        (width, height), (_, low) = self.image_size, self.size
        rows = self.rows.left(image.reshape(height, width * 3).float())
        planes = rows.reshape(1, low, width, 3).permute(0, 3, 1, 2)
        return self.columns.right(planes)


class Banded(nn.Module):
    """Products with the weights of one direction, a band of them at a time, rounded to whole grey levels."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        weights = area_weights(inputs, outputs)
        self.identity = inputs == outputs
        self.spans: list[tuple[int, int]] = []
        for start in range(0, 0 if self.identity else outputs, BAND):
            band = weights[start : start + BAND]
            used = (band > 0).any(axis=0).nonzero()[0]
            first, last = int(used[0]), int(used[-1]) + 1
            self.register_buffer(f"band{len(self.spans)}", torch.from_numpy(band[:, first:last].copy()))
            self.spans.append((first, last))

    def left(self, values: Tensor) -> Tensor:
        """(inputs, n) to (outputs, n)."""
        if self.identity:
            return values
        parts = [getattr(self, f"band{i}") @ values[a:b] for i, (a, b) in enumerate(self.spans)]
        return (torch.cat(parts, dim=0) + 0.5).floor()

    def right(self, values: Tensor) -> Tensor:
        """(..., inputs) to (..., outputs)."""
        if self.identity:
            return values
        parts = [values[..., a:b] @ getattr(self, f"band{i}").T for i, (a, b) in enumerate(self.spans)]
        return (torch.cat(parts, dim=-1) + 0.5).floor()


class _Nearest(torch.autograd.Function):
    """Nearest-pixel enlargement as Pillow does it: output pixel i shows `floor((i + 0.5) * in / out)`."""

    @staticmethod
    def forward(ctx: Any, maps: Tensor, height: int, width: int) -> Tensor:
        return nn.functional.interpolate(maps, size=(height, width), mode="nearest-exact")

    @staticmethod
    def symbolic(g: Any, maps: Any, height: int, width: int) -> Any:
        """The ONNX operator; the exporter's own has no such mode."""
        none = g.op("Constant", value_t=torch.zeros(0))
        size = g.op("Constant", value_t=torch.tensor([1, 1, height, width]))
        modes = {"coordinate_transformation_mode_s": "half_pixel", "nearest_mode_s": "round_prefer_ceil"}
        return g.op("Resize", maps, none, none, size, mode_s="nearest", **modes)


def enlarge_nearest(maps: Tensor, size: tuple[int, int]) -> Tensor:
    """(1, 1, h, w) to (1, 1, H, W) for `size` = (W, H)."""
    enlarged: Tensor = _Nearest.apply(maps, size[1], size[0])
    return enlarged
