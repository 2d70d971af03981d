"""Distances that a depth camera or a lidar measured."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, RangeImage, Truth
from horizon_dl.geometry.polar import Bearings, directions_to_polar
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.resize import nearest
from horizon_dl.ranging.vehicle_height import VehicleHeight

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]
Sectors = NDArray[np.int64]

MIN_POINTS = 3
MIN_SHARE = 0.02


def level_ranges(frame: Frame) -> Floats | None:
    """(h, w) metres from the camera along the floor, NaN where nothing was measured, at the ranges' own size.

    None for frames without ranges or attitude.
    """
    if frame.ranges is None or frame.floor_normal is None:
        return None
    height, width = frame.ranges.metres.shape
    directions = camera_rays(frame.calibrated.scaled(width, height)).directions
    return level_distance(frame.ranges, directions, frame.floor_normal)


def level_distance(ranges: RangeImage, directions: Floats, up_cam: NDArray[np.float64]) -> Floats:
    """(h, w) metres along the floor from measured distances; NaN where there are none.

    Args:
        ranges: (h, w).
        directions: (h, w, 3) unit rays, optical frame.
        up_cam: (3,) the floor's normal.
    """
    along_ray = ranges.metres / directions[..., 2] if ranges.along == "axis" else ranges.metres
    sine = directions @ np.asarray(up_cam, np.float32)
    return np.asarray(along_ray * np.sqrt(np.clip(1 - sine**2, 0.0, 1.0)), np.float32)


def true_obstacles(frame: Frame, range_m: Floats, bearings: Bearings) -> tuple[Mask, Mask]:
    """The truth's own obstacle map, to see what ranging itself gets wrong: what is no floor in front.

    Floor that was measured behind the nearest obstacle of its bearing counts as obstacle. Lidar sees the road
    under bumpers up to 0.35 m high: as floor it would put a car 7.5 m away at 9.5 m.

    Args:
        frame: see `true_distances`.
        range_m: see `true_distances`.
        bearings: see `true_distances`.

    Returns:
        (h, w) what is no free floor, and (h, w) where anything was measured.
    """
    height, width = range_m.shape
    sector, _ = _sectors(frame, height, width, bearings)
    front_m = np.append(true_distances(frame, range_m, bearings), np.float32(np.nan))[sector]
    known = np.isfinite(range_m)
    assert frame.truth is not None  # or true_distances has raised
    with np.errstate(invalid="ignore"):
        behind = range_m > front_m
    return known & ((nearest(frame.truth, height, width) != Truth.FLOOR) | behind), known


def true_distances(
    frame: Frame, range_m: Floats, bearings: Bearings, vehicle: VehicleHeight | None = None
) -> Floats:
    """(sectors,) level distance of the nearest obstacle of each bearing, NaN where none was measured.

    That is the smallest distance within which lie at least 3 points, and 2 % of the sector's points, that
    are labelled obstacle and lie below the camera's height: a few points beside an edge are no obstacle. For
    a vehicle it is what lies as high as it does and is labelled as anything but floor.

    Args:
        frame: with truth and attitude.
        range_m: (h, w) of `level_ranges`; the truth is looked up at its pixels' centres.
        bearings: zero is the optical axis.
        vehicle: how far it reaches below and above the camera; left out: every obstacle below it counts.

    Raises:
        ValueError: the frame has no truth or attitude.
    """
    if frame.truth is None:
        raise ValueError("distances per bearing need truth")
    height, width = range_m.shape
    sector, depression = _sectors(frame, height, width, bearings)
    labels = nearest(frame.truth, height, width)
    if vehicle is None:
        counts = (depression > 0) & (labels == Truth.OBSTACLE)
    else:
        up_m = -range_m * np.tan(depression)
        in_reach = (up_m >= -vehicle.below_m) & (up_m <= vehicle.above_m)
        counts = in_reach & (labels != Truth.FLOOR) & (labels != Truth.IGNORE)
    used = (sector < bearings.count) & counts & np.isfinite(range_m)
    return _smallest_supported(sector[used], range_m[used], bearings.count)


def _sectors(frame: Frame, height: int, width: int, bearings: Bearings) -> tuple[Sectors, Floats]:
    """(h, w) sector of each pixel, `bearings.count` for none, and its depression."""
    up_cam = frame.floor_normal
    if up_cam is None:
        raise ValueError("distances per bearing need an attitude")
    directions = camera_rays(frame.calibrated.scaled(width, height)).directions
    bearing, depression = directions_to_polar(directions, up_cam)
    sector = np.floor(bearing / bearings.step_rad + bearings.count / 2)
    inside = (sector >= 0) & (sector < bearings.count)
    return np.where(inside, sector, bearings.count).astype(np.int64), depression


def _smallest_supported(sector: NDArray[np.int64], distance_m: Floats, count: int) -> Floats:
    """(count,) of each sector the n-th smallest distance, n = max(3, 2 % of its points)."""
    order = np.lexsort((distance_m, sector))
    ordered = distance_m[order]
    points = np.bincount(sector, minlength=count)
    first = np.concatenate([[0], np.cumsum(points)[:-1]])
    needed = np.maximum(MIN_POINTS, np.ceil(MIN_SHARE * points).astype(np.int64))
    enough = points >= needed
    result = np.full(count, np.nan, np.float32)
    result[enough] = ordered[(first + needed - 1)[enough]]
    return result
