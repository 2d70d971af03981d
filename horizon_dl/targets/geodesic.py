"""The horizon label spread along paths that cross no edge, from the horizon and from the sure floor."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.color import rgb2lab
from skimage.graph import MCP_Geometric

from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams
from horizon_dl.uncertainty.measures import log_odds

LEAST_P = 0.002
"""Learned probabilities are kept this far from 0 and 1 before their logit is taken."""

Map = NDArray[np.float32]
Floats = NDArray[np.float64]


def geodesic_target(
    image: NDArray[np.uint8],
    elevation: Map,
    p_above: Map | None = None,
    params: GeodesicParams = GEODESIC,
) -> Map:
    """`0.5 m` below the horizon and `1 - 0.5 m` above, m how much of both sides a pixel has, in [0, 1].

    At first `m = exp(-d)`, d the cost of the path to the horizon: a wall that one can climb to the horizon
    without crossing an edge has a target near 0.5, and a floor behind an edge, or far away, is near its plain
    label. With what a net has learned, m is the mean of that and of `relative_geodesic_position`: an obstacle
    is not only near the horizon, but also far from the sure floor. Without a horizon in the image every label
    is plain.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid; no path leads through such pixels.
        p_above: (h, w) what a net trained on such targets says: its edges are edges, too, and where it is
            surest the paths begin.
        params: what paths cost.

    Returns:
        (h, w) float32 in [0, 1], 1 above, 0.5 on the horizon; NaN where the elevation is NaN.
    """
    cost = traversal_cost(image, elevation, p_above, params)
    distance = horizon_distance(cost, elevation)
    mixed = nearness(distance, elevation, params.length_cost)
    if p_above is not None:
        mixed = (mixed + relative_geodesic_position(cost, elevation, p_above, distance, params)) / 2.0
    return _target(mixed, elevation)


def one_way_target(
    image: NDArray[np.uint8],
    elevation: Map,
    p_above: Map | None = None,
    params: GeodesicParams = GEODESIC,
) -> Map:
    """The geodesic target by the path to the horizon alone, for comparison; see `geodesic_target`."""
    distance = horizon_distance(traversal_cost(image, elevation, p_above, params), elevation)
    return _target(nearness(distance, elevation, params.length_cost), elevation)


def _target(mixed: Map, elevation: Map) -> Map:
    target = np.where(elevation > 0.0, 1.0 - 0.5 * mixed, 0.5 * mixed)
    return np.where(np.isnan(elevation), np.nan, target).astype(np.float32)


def relative_geodesic_position(
    cost: Map, elevation: Map, p_above: Map, distance: Floats, params: GeodesicParams = GEODESIC
) -> Map:
    """Where a pixel lies on the path from what a net is surest of, 0, to the horizon, 1: `s / (s + d)`.

    s is the cost of the path to the sure pixels of the own side, d that of the path to the horizon. So a low
    obstacle, which edges separate both from the horizon and from the floor, lies in the middle.

    Args:
        cost: (h, w) of a step, see `traversal_cost`.
        elevation: (h, w) rad, NaN where the ray is not valid.
        p_above: (h, w) what the net says.
        distance: (h, w) d, of `horizon_distance`.
        params: what is sure.

    Returns:
        (h, w) float32 in [0, 1]; 0 where no path leads to the horizon, 0.5 where one does and none to
        anything sure.
    """
    horizon = horizon_seeds(elevation)
    if not horizon.any():
        return np.zeros(elevation.shape, np.float32)
    # Paths end at the horizon: what is sure on the other side of it says nothing about this one.
    to_sure = path_cost(
        np.where(horizon, np.inf, cost), confident_seeds(elevation, p_above, params) & ~horizon
    )
    reached = np.isfinite(distance)
    share = np.where(horizon, 1.0, np.where(reached, 0.5, 0.0))
    np.divide(to_sure, to_sure + distance, out=share, where=reached & np.isfinite(to_sure) & ~horizon)
    return share.astype(np.float32)


def confident_seeds(elevation: Map, p_above: Map, params: GeodesicParams = GEODESIC) -> NDArray[np.bool_]:
    """(h, w) bool: those of each side where the net is surest of that side, the far ones before the near.

    Where the net is nearly as sure of a dark obstacle as of the floor, the floor is what lies lower.
    """
    odds = np.where(elevation > 0.0, 1.0, -1.0) * log_odds(p_above, LEAST_P)
    sureness = odds + params.angle_weight * relative_angle(elevation)
    sure = np.zeros(elevation.shape, bool)
    for side in (elevation > 0.0, elevation <= 0.0):
        if side.any():
            sure |= side & (sureness >= np.quantile(sureness[side], 1.0 - params.sure_share))
    return sure


def relative_angle(elevation: Map) -> Map:
    """Angle from the horizon over its mean in the image, (h, w); NaN where the elevation is NaN."""
    angle = np.abs(elevation)
    known = angle[~np.isnan(angle)]
    return (angle / max(float(known.mean()) if known.size else 1.0, 1e-6)).astype(np.float32)


def horizon_distance(cost: Map, elevation: Map) -> Floats:
    """Least cost of a path through the image from each pixel to the horizon line.

    Args:
        cost: (h, w) of a step, see `traversal_cost`.
        elevation: (h, w) rad, NaN where the ray is not valid.

    Returns:
        (h, w), 0 along the horizon, infinite where no path leads there.
    """
    return path_cost(cost, horizon_seeds(elevation))


def nearness(distance: Floats, elevation: Map, least_scale: float = GEODESIC.length_cost) -> Map:
    """`exp(-d)` of the distance to the horizon, (h, w) in [0, 1], 1 on it.

    The distance is taken relative to its mean below the horizon: neither light nor resolution matter.
    """
    below = distance[(elevation <= 0.0) & np.isfinite(distance)]
    scale = max(float(below.mean()) if below.size else 1.0, least_scale)
    near: Map = np.exp(-(distance / scale).astype(np.float32))
    return near


def path_cost(cost: Map, seeds: NDArray[np.bool_]) -> Floats:
    """Least cost of a path from each pixel to a seed, (h, w); infinite where no path leads to one."""
    if not seeds.any():
        return np.full(cost.shape, np.inf)
    # A path into a patch of seeds ends at its rim; the path finder is slow at taking up seeds.
    rim = seeds & ~ndimage.binary_erosion(seeds, np.ones((3, 3)), border_value=1)
    distance: Floats = MCP_Geometric(cost).find_costs(np.argwhere(rim if rim.any() else seeds))[0]
    distance[seeds] = 0.0
    return distance


def traversal_cost(
    image: NDArray[np.uint8],
    elevation: Map,
    p_above: Map | None = None,
    params: GeodesicParams = GEODESIC,
) -> Map:
    """Cost of a step of one pixel: a constant, the image's edges, and the learned ones.

    It grows with the gradient relative to the image's mean gradient, so that contrast does not matter.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        p_above: see `geodesic_target`.
        params: see there.

    Returns:
        (h, w) float32, infinite where the ray is not valid.
    """
    blur_px = params.blur * np.sqrt(image.shape[0] * image.shape[1])
    cost = edge_cost(lab_gradient(image, blur_px, params.chroma), params)
    if p_above is not None:
        learned = gradient_size(log_odds(p_above, LEAST_P)[..., None], blur_px / 2)
        cost = params.image_share * cost + edge_cost(learned, params)
    # The path finder crashes on NaN, which a net that went astray may give.
    barred = np.isnan(elevation) | np.isnan(cost)
    return np.where(barred, np.float32(np.inf), params.length_cost + cost)


def edge_cost(gradient: Map, params: GeodesicParams = GEODESIC) -> Map:
    """Cost of crossing a gradient, relative to its mean over the image, (h, w) in [0, edge_limit]."""
    relative = gradient / max(float(gradient.mean()), 1e-3)
    cost: Map = np.minimum(relative**params.edge_power, params.edge_limit)
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


def lab_gradient(image: NDArray[np.uint8], blur_px: float, chroma: float = GEODESIC.chroma) -> Map:
    """Size of the gradient, CIE Lab units per pixel, colours weighted by `chroma`: (h, w) float32."""
    lab = rgb2lab(image.astype(np.float32) / 255.0) * (1.0, chroma, chroma)
    return gradient_size(lab, blur_px)


def gradient_size(values: NDArray[np.floating], blur_px: float) -> Map:
    """Size of the gradient of (h, w, channels) values after a blur, units per pixel: (h, w) float32."""
    smooth = ndimage.gaussian_filter(values, (blur_px, blur_px, 0.0), truncate=3.0)
    down, right = (np.zeros_like(smooth) for _ in range(2))
    down[1:-1] = (smooth[2:] - smooth[:-2]) / 2
    right[:, 1:-1] = (smooth[:, 2:] - smooth[:, :-2]) / 2
    size: Map = np.sqrt((down**2 + right**2).sum(axis=-1)).astype(np.float32)
    return size
