"""The horizon label spread along paths through the image that cross no edge."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.color import rgb2lab
from skimage.graph import MCP_Geometric

BLUR = 0.0072
"""Standard deviation of the blur before the gradient, in square roots of the image's area."""
CHROMA = 0.25
"""Weight of the colours against the lightness: shades of one surface differ more in colour than is useful."""
EDGE_POWER = 1.5
"""An edge twice as steep is more than twice as dear, so that texture is cheap and contours are not."""
EDGE_LIMIT = 6.0
"""No edge is dearer than this many times the image's mean gradient."""
LENGTH_COST = 0.1
"""Cost of a step where nothing changes, in mean gradients."""


def geodesic_target(image: NDArray[np.uint8], elevation: NDArray[np.float32]) -> NDArray[np.float32]:
    """`0.5 exp(-d)` below the horizon and `1 - 0.5 exp(-d)` above, d the cost of the way to the horizon.

    So a wall that one can climb to the horizon without crossing an edge has a target near 0.5, and a floor
    behind an edge, or far away, is near its plain label. Without a horizon in the image every label is plain.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid; no path leads through such pixels.

    Returns:
        (h, w) float32 in [0, 1], 1 above, 0.5 on the horizon; NaN where the elevation is NaN.
    """
    mixed = 0.5 * np.exp(-horizon_distance(image, elevation))
    target = np.where(elevation > 0.0, 1.0 - mixed, mixed)
    return np.where(np.isnan(elevation), np.nan, target).astype(np.float32)


def horizon_distance(image: NDArray[np.uint8], elevation: NDArray[np.float32]) -> NDArray[np.float32]:
    """Least cost of a path through the image from each pixel to the horizon line, 1 in the mean.

    The cost of a step grows with the gradient relative to the image's mean gradient, and the distance is
    relative to its mean below the horizon: neither contrast, light nor resolution matter.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.

    Returns:
        (h, w) float32, 0 along the horizon, 1 in the mean over the pixels below it, infinite where no path
        leads there.
    """
    seeds = horizon_seeds(elevation)
    if not seeds.any():
        return np.full(elevation.shape, np.inf, np.float32)
    cost = np.where(np.isnan(elevation), np.inf, step_cost(image))
    distance: NDArray[np.float64] = MCP_Geometric(cost).find_costs(np.argwhere(seeds))[0]
    below = distance[(elevation <= 0.0) & np.isfinite(distance)]
    return (distance / max(below.mean(), LENGTH_COST)).astype(np.float32)


def step_cost(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Cost of a step of one pixel: (h, w) float32 in [LENGTH_COST, LENGTH_COST + EDGE_LIMIT]."""
    gradient = lab_gradient(image, BLUR * np.sqrt(image.shape[0] * image.shape[1]))
    relative = gradient / max(float(gradient.mean()), 1e-3)
    return LENGTH_COST + np.minimum(relative**EDGE_POWER, EDGE_LIMIT)


def horizon_seeds(elevation: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(h, w) bool: pixels with a neighbour (of 4) on the other side of the horizon."""
    above = elevation > 0.0
    known = ~np.isnan(elevation)
    seeds = np.zeros(elevation.shape, bool)
    rows = (above[1:] != above[:-1]) & known[1:] & known[:-1]
    columns = (above[:, 1:] != above[:, :-1]) & known[:, 1:] & known[:, :-1]
    seeds[1:] |= rows
    seeds[:-1] |= rows
    seeds[:, 1:] |= columns
    seeds[:, :-1] |= columns
    return seeds


def lab_gradient(image: NDArray[np.uint8], sigma_px: float) -> NDArray[np.float32]:
    """Size of the gradient, CIE Lab units per pixel, colours weighted by `CHROMA`: (h, w) float32."""
    lab = rgb2lab(image.astype(np.float32) / 255.0) * (1.0, CHROMA, CHROMA)
    smooth = ndimage.gaussian_filter(lab, (sigma_px, sigma_px, 0.0), truncate=3.0)
    down, right = (np.zeros_like(smooth) for _ in range(2))
    down[1:-1] = (smooth[2:] - smooth[:-2]) / 2
    right[:, 1:-1] = (smooth[:, 2:] - smooth[:, :-2]) / 2
    return np.sqrt((down**2 + right**2).sum(axis=-1)).astype(np.float32)
