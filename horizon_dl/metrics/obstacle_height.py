"""The second truth, by height: obstacles as the method defines them, standing on both sides of the horizon.

A car lower than the camera is an obstacle to a lidar's label (higher than 0.35 m), and none to the paper,
since nothing of it is ever seen above the horizon. Where distances were measured, the obstacle pixels are
divided into those of things that reach the camera's height and those of things that do not.
"""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, Truth
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.resize import nearest
from horizon_dl.metrics.range_truth import level_ranges
from horizon_dl.metrics.scored_pixels import ScoredPixels

STRIPS = 320
"""Columns of obstacle points, over the image's width: a lidar with 0.1 to 0.2 degrees a step fills each."""
GAP_M = 0.3
GAP_SHARE = 0.05
"""Points of a column belong to one thing unless they lie this far apart, or this share of their distance."""
UNKNOWN, LOW, CROSSING = 0, 1, 2

Floats = NDArray[np.float32]
Labels = NDArray[np.uint8]


def by_height(frame: Frame, below: ScoredPixels) -> dict[str, ScoredPixels]:
    """`crossing` and `low`: all floor pixels with the one or the other kind of obstacle.

    Obstacle pixels without a measurement are in neither. Empty for frames without ranges or truth.

    Args:
        frame: with ranges.
        below: its scored pixels below the horizon.
    """
    range_m = level_ranges(frame)
    if range_m is None or frame.truth is None or frame.up_cam is None:
        return {}
    kind = obstacle_kinds(frame.truth, range_m, _elevation(frame, range_m))[below.mask]
    kinds = {"crossing": CROSSING, "low": LOW}
    return {name: below.keep(~below.obstacle | (kind == one)) for name, one in kinds.items()}


def obstacle_kinds(truth: Labels, range_m: Floats, elevation_rad: Floats) -> Labels:
    """Which obstacle pixels belong to things that reach the camera's height.

    Obstacle points of an image column (a strip of it) with no gap between their distances are one thing. It
    crosses the horizon if any of its points, those above the horizon included, lies on or over it.

    Args:
        truth: (H, W) of `Truth`.
        range_m: (h, w) level distances, NaN where nothing was measured; any size of the same aspect.
        elevation_rad: (h, w) of the same pixels.

    Returns:
        (H, W) of `UNKNOWN` (no obstacle, or not measured), `LOW` and `CROSSING`.
    """
    height, width = range_m.shape
    kinds = np.full((height, width), UNKNOWN, np.uint8)
    points = (nearest(truth, height, width) == Truth.OBSTACLE) & np.isfinite(range_m + elevation_rad)
    if points.any():
        strip = np.nonzero(points)[1] * STRIPS // width
        top_rad = _tops(strip, range_m[points], elevation_rad[points])
        kinds[points] = np.where(top_rad >= 0.0, CROSSING, LOW)
    return nearest(kinds, *truth.shape)


def _tops(strip: NDArray[np.intp], distance_m: Floats, elevation_rad: Floats) -> Floats:
    """(n,) the highest elevation, rad, of the thing that each point belongs to."""
    order = np.lexsort((distance_m, strip))
    far_m = distance_m[order]
    apart = np.diff(far_m) > np.maximum(GAP_M, GAP_SHARE * far_m[1:])
    first = np.concatenate([[True], apart | (np.diff(strip[order]) != 0)])
    tops = np.maximum.reduceat(elevation_rad[order], np.flatnonzero(first))
    result = np.empty_like(elevation_rad)
    result[order] = tops[np.cumsum(first) - 1]
    return result


def _elevation(frame: Frame, range_m: Floats) -> Floats:
    height, width = range_m.shape
    assert frame.up_cam is not None
    return elevation(camera_rays(frame.calibrated.scaled(width, height)).directions, frame.up_cam)
