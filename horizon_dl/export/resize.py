"""Resizing inside the graph: area averaging before the net, nearest pixel for the obstacle map."""

import numpy as np
import torch
from torch import Tensor, nn

from horizon_dl.geometry.resize import area_weights, nearest_pixels

BAND = 16
"""Output pixels a matrix product; the weights are a narrow band, most of a whole matrix would be zeros."""


class AreaShrink(nn.Module):
    """`area_resize` of (1, H, W, 3) uint8 to (1, 3, h, w) float of whole grey levels, equal to the bit.

    An image of that size already passes as it is.

    What moves through memory between the two directions is uint8, a quarter of the floats.

    Args:
        image_size: (W, H).
        size: (w, h), not larger.
    """

    def __init__(self, image_size: tuple[int, int], size: tuple[int, int]) -> None:
        super().__init__()
        self.image_size, self.size = image_size, size
        self.shrinks = image_size != size
        self.rows = Banded(image_size[1], size[1])
        self.columns = Banded(image_size[0], size[0])

    def forward(self, image: Tensor) -> Tensor:
        """Reduce; rows first, as `area_resize` does."""
        if not self.shrinks:
            return image
        (width, height), (low_width, low) = self.image_size, self.size
        rows = self.rows.left(image.reshape(height, width * 3))
        planes = rows.reshape(1, low, width, 3).permute(0, 3, 1, 2).reshape(3 * low, width)
        return self.columns.right(planes).reshape(1, 3, low, low_width)


class Banded(nn.Module):
    """Products with the weights of one direction, a band of them at a time, rounded to whole grey levels."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        weights = area_weights(inputs, outputs)
        self.spans: list[tuple[int, int]] = []
        for start in range(0, 0 if inputs == outputs else outputs, BAND):
            band = weights[start : start + BAND]
            used = np.flatnonzero(band.max(axis=0))
            first, last = int(used[0]), int(used[-1]) + 1
            self.register_buffer(f"band{len(self.spans)}", torch.from_numpy(band[:, first:last].copy()))
            self.spans.append((first, last))

    def left(self, values: Tensor) -> Tensor:
        """(inputs, n) uint8 to (outputs, n) uint8."""
        if not self.spans:
            return values
        products = [self._band(i) @ values[a:b].float() for i, (a, b) in enumerate(self.spans)]
        return torch.cat([(product + 0.5).to(torch.uint8) for product in products], dim=0)

    def right(self, values: Tensor) -> Tensor:
        """(n, inputs) uint8 to (n, outputs) float."""
        if not self.spans:
            return values.float()
        products = [values[:, a:b].float() @ self._band(i).T for i, (a, b) in enumerate(self.spans)]
        return torch.cat([(product + 0.5).floor() for product in products], dim=1)

    def _band(self, index: int) -> Tensor:
        band: Tensor = getattr(self, f"band{index}")
        return band


class NearestEnlarge(nn.Module):
    """Nearest-pixel enlargement, see `nearest_pixels`.

    Both directions repeat whole rows, the other one between two transpositions: faster than the operator
    for it, and exact, where that one's float32 coordinates are not.
    """

    def __init__(self, size: tuple[int, int], image_size: tuple[int, int]) -> None:
        super().__init__()
        self.columns = torch.from_numpy(nearest_pixels(size[0], image_size[0]))
        self.rows = torch.from_numpy(nearest_pixels(size[1], image_size[1]))

    def forward(self, maps: Tensor) -> Tensor:
        """(h, w) to (H, W)."""
        return maps.T[self.columns].T[self.rows]
