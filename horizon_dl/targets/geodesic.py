"""The horizon label spread along paths through the image that cross no edge."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.color import rgb2lab
from skimage.graph import MCP_Geometric


def geodesic_target(
    image: NDArray[np.uint8],
    elevation: NDArray[np.float32],
    colour_cost: float = 0.03,
    length_cost: float = 0.3,
    blur: float = 0.01,
) -> NDArray[np.float32]:
    """`0.5 exp(-d)` below the horizon and `1 - 0.5 exp(-d)` above, d the cost of the way to the horizon.

    So a wall that one can climb to the horizon without crossing an edge has a target near 0.5, and a floor
    behind an edge, or far away, has its plain label. Without a horizon in the image every label is plain.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid; no path leads through such pixels.
        colour_cost: see `horizon_distance`.
        length_cost: see `horizon_distance`.
        blur: see `horizon_distance`.

    Returns:
        (h, w) float32 in [0, 1], 1 above, 0.5 on the horizon; NaN where the elevation is NaN.
    """
    mixed = 0.5 * np.exp(-horizon_distance(image, elevation, colour_cost, length_cost, blur))
    target = np.where(elevation > 0.0, 1.0 - mixed, mixed)
    return np.where(np.isnan(elevation), np.nan, target).astype(np.float32)


def horizon_distance(
    image: NDArray[np.uint8],
    elevation: NDArray[np.float32],
    colour_cost: float = 0.03,
    length_cost: float = 0.3,
    blur: float = 0.01,
) -> NDArray[np.float32]:
    """Least cost of a path through the image from each pixel to the horizon line.

    Both costs are independent of the resolution: an edge costs its height however many pixels it takes.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        colour_cost: cost of a change of colour by one unit of CIE Lab on the way.
        length_cost: cost of a way as long as the image is high.
        blur: standard deviation of the blur before the gradient, in image heights.

    Returns:
        (h, w) float32, 0 along the horizon, infinite where no path leads there.
    """
    seeds = horizon_seeds(elevation)
    if not seeds.any():
        return np.full(elevation.shape, np.inf, np.float32)
    height = image.shape[0]
    cost = colour_cost * lab_gradient(image, blur * height) + length_cost / height
    cost = np.where(np.isnan(elevation), np.inf, cost)
    distance: NDArray[np.float64] = MCP_Geometric(cost).find_costs(np.argwhere(seeds))[0]
    return distance.astype(np.float32)


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
    """Size of the colour gradient, CIE Lab units per pixel: (h, w) float32 from an (h, w, 3) uint8 image."""
    lab = rgb2lab(image.astype(np.float32) / 255.0)
    smooth = ndimage.gaussian_filter(lab, (sigma_px, sigma_px, 0.0))
    down, right = (ndimage.correlate1d(smooth, (-0.5, 0.0, 0.5), axis, mode="nearest") for axis in (0, 1))
    slope: NDArray[np.float32] = np.sqrt((down**2 + right**2).sum(axis=-1))
    return slope
