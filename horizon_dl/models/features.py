"""What the forest sees of a pixel: colour, local binary pattern, and Laws texture."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.color import rgb2gray, rgb2hsv
from skimage.feature import local_binary_pattern

LBP_POINTS = 24
LBP_RADIUS_PX = 3
LAWS_VECTORS = {"L3": (1.0, 2.0, 1.0), "E3": (-1.0, 0.0, 1.0), "S3": (-1.0, 2.0, -1.0)}
FEATURE_NAMES = ("hue", "saturation", "value", "lbp", *(a + b for a in LAWS_VECTORS for b in LAWS_VECTORS))


def pixel_features(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Features of every pixel, in the order of `FEATURE_NAMES`.

    Hue, saturation and value in [0, 1]; the uniform local binary pattern (24 points at radius 3 pixels) as
    one number in 0..25; nine Laws responses of the grey image. Source: arXiv:1806.08007, section III.

    Args:
        image: (h, w, 3) uint8 RGB.

    Returns:
        (h, w, 13) float32.
    """
    grey = rgb2gray(image).astype(np.float32)
    hsv = rgb2hsv(image)
    return np.dstack([hsv, uniform_lbp(grey), laws_responses(grey)]).astype(np.float32)


def uniform_lbp(grey: NDArray[np.float32]) -> NDArray[np.float32]:
    """Rotation-invariant uniform local binary pattern (Ojala et al. 2002).

    Args:
        grey: (h, w) in [0, 1]; rounded to 8 bits first, so that a flat surface gives ties and not noise.

    Returns:
        (h, w) float32: 0..24 is the number of brighter points of a uniform pattern, 25 any other pattern.
    """
    levels = np.rint(grey * 255.0).astype(np.uint8)
    pattern: NDArray[np.float64] = local_binary_pattern(levels, LBP_POINTS, LBP_RADIUS_PX, method="uniform")
    return pattern.astype(np.float32)


def laws_responses(grey: NDArray[np.float32]) -> NDArray[np.float32]:
    """Responses to the nine 3x3 Laws masks, outer products of level, edge and spot (Laws 1980).

    Args:
        grey: (h, w) in [0, 1]; the border is mirrored.

    Returns:
        (h, w, 9) float32, vertical vector first: L3L3, L3E3, ..., S3S3.
    """
    columns = [ndimage.convolve1d(grey, vertical, axis=0) for vertical in LAWS_VECTORS.values()]
    rows = [
        ndimage.convolve1d(column, horizontal, axis=1)
        for column in columns
        for horizontal in LAWS_VECTORS.values()
    ]
    return np.stack(rows, axis=-1)
