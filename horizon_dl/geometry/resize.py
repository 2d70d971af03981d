"""Reducing an image by area averaging, in arithmetic that every runtime repeats to the bit.

The weights are whole numbers of 4096ths and each pass rounds to whole grey levels, so all sums are exact in
float32, whatever their order: the exported graph does the same with matrix products.
"""

from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T", bound=np.generic)

WEIGHT_STEPS = 4096
"""255 * 4096 is far below 2 ** 24, up to which float32 holds every whole number."""


def area_weights(inputs: int, outputs: int) -> NDArray[np.float32]:
    """Matrix (outputs, inputs) of the overlaps of output pixels with input pixels; rows sum to one.

    Each weight is a whole number of 4096ths; the remainder of a row goes to its largest fractions.

    Example:
        >>> area_weights(3, 2).round(2).tolist()
        [[0.67, 0.33, 0.0], [0.0, 0.33, 0.67]]
    """
    scale = inputs / outputs
    left = np.arange(outputs)[:, None] * scale
    pixel = np.arange(inputs)[None]
    overlap = np.clip(np.minimum(left + scale, pixel + 1) - np.maximum(left, pixel), 0.0, None)
    exact = overlap / overlap.sum(axis=1, keepdims=True) * WEIGHT_STEPS
    steps = np.floor(exact)
    missing = (WEIGHT_STEPS - steps.sum(axis=1)).astype(int)
    rank = np.argsort(np.argsort(steps - exact, axis=1, kind="stable"), axis=1, kind="stable")
    steps += rank < missing[:, None]
    weights: NDArray[np.float32] = (steps / WEIGHT_STEPS).astype(np.float32)
    return weights


def area_resize(image: NDArray[np.uint8], size: tuple[int, int]) -> NDArray[np.uint8]:
    """An (H, W, C) uint8 image reduced to `size` = (width, height), rows first.

    Raises:
        ValueError: the size is larger than the image.

    Example:
        >>> area_resize(np.array([[[0], [10]], [[20], [30]]], np.uint8), (1, 1)).tolist()
        [[[15]]]
    """
    height, width, channels = image.shape
    if size[0] > width or size[1] > height:
        raise ValueError(f"cannot reduce {width}x{height} pixels to {size[0]}x{size[1]}")
    low = _reduce_rows(image.reshape(height, width * channels), size[1])
    turned = np.ascontiguousarray(low.reshape(size[1], width, channels).swapaxes(0, 1))
    small = _reduce_rows(turned.reshape(width, size[1] * channels), size[0])
    return np.ascontiguousarray(small.reshape(size[0], size[1], channels).swapaxes(0, 1))


def halved(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Mean of 2x2 pixels, (h // 2, w // 2) of (h, w); NaN where one of them is NaN.

    Example:
        >>> halved(np.array([[0.0, 1.0, 9.0], [1.0, 2.0, 9.0]], np.float32)).tolist()
        [[1.0]]
    """
    height, width = (side // 2 for side in values.shape)
    blocks = values[: 2 * height, : 2 * width].reshape(height, 2, width, 2)
    mean: NDArray[np.float32] = blocks.mean(axis=(1, 3), dtype=np.float32)
    return mean


def _reduce_rows(values: NDArray[np.uint8], outputs: int) -> NDArray[np.uint8]:
    """(inputs, n) to (outputs, n)."""
    if len(values) == outputs:
        return values
    total = np.full((outputs, values.shape[1]), 0.5, np.float32)
    for pixel, weight in _taps(len(values), outputs):
        total += values[pixel] * weight
    return total.astype(np.uint8)


@lru_cache(maxsize=16)
def _taps(inputs: int, outputs: int) -> list[tuple[NDArray[np.intp], NDArray[np.float32]]]:
    """Input pixel (outputs,) and weight (outputs, 1) of every tap of the averages."""
    weights = area_weights(inputs, outputs)
    first = (weights > 0).argmax(axis=1)
    count = int((weights > 0).sum(axis=1).max())
    padded = np.pad(weights, ((0, 0), (0, count)))
    rows = np.arange(outputs)
    return [(np.minimum(first + tap, inputs - 1), padded[rows, first + tap][:, None]) for tap in range(count)]


def nearest_pixels(inputs: int, outputs: int) -> NDArray[np.intp]:
    """The input pixel that each output pixel shows: `floor((i + 0.5) * inputs / outputs)` in whole numbers.

    Pillow and OpenCV compute it in floating point and are a pixel off where that is exactly a whole number.

    Example:
        >>> nearest_pixels(2, 5).tolist()
        [0, 0, 1, 1, 1]
    """
    return (2 * np.arange(outputs) + 1) * inputs // (2 * outputs)


def nearest(image: NDArray[T], height: int, width: int) -> NDArray[T]:
    """A label image or mask (H, W) at another size, by the pixel under each centre; see `nearest_pixels`."""
    rows, columns = nearest_pixels(image.shape[0], height), nearest_pixels(image.shape[1], width)
    return image[np.ix_(rows, columns)]
