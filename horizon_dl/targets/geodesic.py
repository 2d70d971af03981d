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
"""No edge is dearer than this many times the mean gradient."""
LENGTH_COST = 0.1
"""Cost of a step where nothing changes, in mean gradients."""
IMAGE_SHARE = 0.5
"""Weight of the image's edges where there are learned ones beside them."""
LEAST_P = 0.002
"""Learned probabilities are kept this far from 0 and 1 before their logit is taken."""

Map = NDArray[np.float32]


def geodesic_target(image: NDArray[np.uint8], elevation: Map, p_above: Map | None = None) -> Map:
    """`0.5 exp(-d)` below the horizon and `1 - 0.5 exp(-d)` above, d the cost of the way to the horizon.

    So a wall that one can climb to the horizon without crossing an edge has a target near 0.5, and a floor
    behind an edge, or far away, is near its plain label. Without a horizon in the image every label is plain.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid; no path leads through such pixels.
        p_above: (h, w) what a net trained on such targets says, whose edges are then edges, too.

    Returns:
        (h, w) float32 in [0, 1], 1 above, 0.5 on the horizon; NaN where the elevation is NaN.
    """
    mixed = 0.5 * np.exp(-horizon_distance(image, elevation, p_above))
    target = np.where(elevation > 0.0, 1.0 - mixed, mixed)
    return np.where(np.isnan(elevation), np.nan, target).astype(np.float32)


def horizon_distance(image: NDArray[np.uint8], elevation: Map, p_above: Map | None = None) -> Map:
    """Least cost of a path through the image from each pixel to the horizon line, 1 in the mean.

    The cost of a step grows with the gradient relative to the image's mean gradient, and the distance is
    relative to its mean below the horizon: neither contrast, light nor resolution matter.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        p_above: see `geodesic_target`.

    Returns:
        (h, w) float32, 0 along the horizon, 1 in the mean over the pixels below it, infinite where no path
        leads there.
    """
    seeds = horizon_seeds(elevation)
    if not seeds.any():
        return np.full(elevation.shape, np.inf, np.float32)
    cost = np.where(np.isnan(elevation), np.inf, step_cost(image, p_above))
    distance: NDArray[np.float64] = MCP_Geometric(cost).find_costs(np.argwhere(seeds))[0]
    below = distance[(elevation <= 0.0) & np.isfinite(distance)]
    scale = max(float(below.mean()) if below.size else 1.0, LENGTH_COST)
    return (distance / scale).astype(np.float32)


def step_cost(image: NDArray[np.uint8], p_above: Map | None = None) -> Map:
    """Cost of a step of one pixel, (h, w) float32: a constant, the image's edges, and the learned ones."""
    blur_px = BLUR * np.sqrt(image.shape[0] * image.shape[1])
    image_edges = edge_cost(lab_gradient(image, blur_px))
    if p_above is None:
        return LENGTH_COST + image_edges
    p = p_above.clip(LEAST_P, 1.0 - LEAST_P)
    learned_edges = edge_cost(gradient_size(np.log(p / (1.0 - p))[..., None], blur_px / 2))
    return LENGTH_COST + IMAGE_SHARE * image_edges + learned_edges


def edge_cost(gradient: Map) -> Map:
    """Cost of crossing a gradient, relative to its mean over the image, (h, w) in [0, EDGE_LIMIT]."""
    relative = gradient / max(float(gradient.mean()), 1e-3)
    cost: Map = np.minimum(relative**EDGE_POWER, EDGE_LIMIT)
    return cost


def horizon_seeds(elevation: Map) -> NDArray[np.bool_]:
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


def lab_gradient(image: NDArray[np.uint8], blur_px: float) -> Map:
    """Size of the gradient, CIE Lab units per pixel, colours weighted by `CHROMA`: (h, w) float32."""
    lab = rgb2lab(image.astype(np.float32) / 255.0) * (1.0, CHROMA, CHROMA)
    return gradient_size(lab, blur_px)


def gradient_size(values: NDArray[np.floating], blur_px: float) -> Map:
    """Size of the gradient of (h, w, channels) values after a blur, units per pixel: (h, w) float32."""
    smooth = ndimage.gaussian_filter(values, (blur_px, blur_px, 0.0), truncate=3.0)
    down, right = (np.zeros_like(smooth) for _ in range(2))
    down[1:-1] = (smooth[2:] - smooth[:-2]) / 2
    right[:, 1:-1] = (smooth[:, 2:] - smooth[:, :-2]) / 2
    size: Map = np.sqrt((down**2 + right**2).sum(axis=-1)).astype(np.float32)
    return size
