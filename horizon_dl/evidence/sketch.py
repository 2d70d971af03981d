"""Brightness, and small grey sketches in which exposure and motion are judged at next to no cost."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from horizon_dl.geometry.camera import working_size

Sketch = NDArray[np.uint8]

LUMA = np.array([0.299, 0.587, 0.114], np.float32)
SKETCH_PIXELS = 64 * 48
SAME_LEVELS = 0.05
"""Sketches of one moment differ by less than this in the mean; the noise of a sensor alone by more."""


def luma(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    """(h, w) float32 brightness in [0, 255] of an RGB image."""
    return np.asarray(image.astype(np.float32) @ LUMA, np.float32)


def sketch_of(image: NDArray[np.uint8]) -> Sketch:
    """A small grey picture (h, w) uint8 of at most 64x48 pixels with the image's aspect."""
    height, width = image.shape[:2]
    size = working_size(width, height, SKETCH_PIXELS)
    smaller = Image.fromarray(image).reduce(max(1, min(width // size[0], height // size[1])))
    return np.asarray(smaller.convert("L").resize(size, Image.Resampling.BOX))


def same_picture(one: Sketch, other: Sketch) -> bool:
    """Whether two sketches are of one and the same exposure."""
    return one.shape == other.shape and difference(one, other) < SAME_LEVELS


def difference(one: ArrayLike, other: ArrayLike) -> float:
    """Mean absolute difference, grey levels."""
    return float(np.abs(np.asarray(one, np.float32) - np.asarray(other, np.float32)).mean())
