"""A frame's pixels below the horizon, sorted by bearing and depression.

A bearing is a vertical plane through the camera, not an image column: the camera rolls and the lens bends.
Counting pixels into cells needs nothing but rays, so it holds for any lens.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float32]

OPTICAL_AXIS = (0.0, 0.0, 1.0)
LEVEL_UP = (0.0, -1.0, 0.0)
STEP_RAD = math.radians(1.25)  # four to an element of 5 degrees of OBSTACLE_DISTANCE
MIN_ROWS = 2


@dataclass(frozen=True)
class Bearings:
    """Sectors of equal width, rad; bearings are zero straight ahead and grow clockwise, seen from above.

    Example:
        >>> [round(math.degrees(b)) for b in Bearings(3, math.radians(10)).centres_rad]
        [-10, 0, 10]
    """

    count: int = 72
    step_rad: float = STEP_RAD

    @property
    def centres_rad(self) -> Floats:
        """(count,) the middle of each sector, symmetric about straight ahead."""
        return ((np.arange(self.count) - (self.count - 1) / 2) * self.step_rad).astype(np.float32)


@dataclass(frozen=True)
class PolarView:
    """Where each pixel of a frame belongs, and how many pixels each cell has.

    Attributes:
        bearings: the sectors.
        cell: (h, w) int32 index `sector * rows + row`; the last index + 1 for pixels of no cell.
        rows: cells a sector; row 0 touches the horizon, the last one is the nearest ground.
        row_step_rad: height of a row.
        pixels: (sectors, rows) float32 number of pixels.
    """

    bearings: Bearings
    cell: NDArray[np.int32]
    rows: int
    row_step_rad: float
    pixels: Floats

    @property
    def depression_rad(self) -> Floats:
        """(rows,) the middle of each row below the horizon."""
        return ((np.arange(self.rows) + 0.5) * self.row_step_rad).astype(np.float32)

    def counts(self, mask: NDArray[np.bool_]) -> Floats:
        """(sectors, rows) how many pixels of a (h, w) mask each cell has."""
        size = self.bearings.count * self.rows
        found = np.bincount(self.cell[mask], minlength=size + 1)[:size]
        return found.reshape(self.bearings.count, self.rows).astype(np.float32)

    def means(self, values: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """(sectors, rows) mean of a (h, w) map in each cell, 0 for none, and which cells have one."""
        known = ~np.isnan(values)
        size = self.bearings.count * self.rows
        total = np.bincount(self.cell[known], weights=values[known], minlength=size + 1)[:size]
        counts = self.counts(known)
        mean = total.reshape(counts.shape) / np.maximum(counts, 1)
        return mean.astype(np.float32), counts > 0


def level_axes(up_cam: ArrayLike, forward_cam: ArrayLike) -> Floats:
    """(3, 3) rows ahead, right, up of a level frame, written in the optical frame.

    Args:
        up_cam: (3,) unit, the floor's normal.
        forward_cam: (3,) what bearing zero means; only its level part counts.

    Raises:
        ValueError: `forward_cam` is vertical.
    """
    up = np.asarray(up_cam, np.float64)
    ahead = np.asarray(forward_cam, np.float64)
    ahead = ahead - (ahead @ up) * up
    length = float(np.linalg.norm(ahead))
    if length < 1e-3:
        raise ValueError("the direction of bearing zero is vertical")
    ahead = ahead / length
    return np.stack([ahead, np.cross(ahead, up), up]).astype(np.float32)


def directions_to_polar(
    directions: Floats, up_cam: ArrayLike, forward_cam: ArrayLike = OPTICAL_AXIS
) -> tuple[Floats, Floats]:
    """Bearing and depression of rays, rad.

    Args:
        directions: (..., 3) unit rays, optical frame, NaN where not valid.
        up_cam: (3,) unit.
        forward_cam: (3,) bearing zero.

    Returns:
        Two arrays (...): bearing in (-pi, pi], clockwise; depression in [-pi/2, pi/2], positive below.
    """
    ahead, right, up = (directions @ axis for axis in level_axes(up_cam, forward_cam))
    return np.arctan2(right, ahead), np.arcsin(np.clip(-up, -1.0, 1.0))


def bearings_for(rays: Floats, forward_cam: ArrayLike) -> Bearings:
    """Sectors of 1.25 degrees, symmetric about straight ahead, that hold all of a level camera's view."""
    bearing, _ = directions_to_polar(rays, LEVEL_UP, forward_cam)
    widest = float(np.nanmax(np.abs(bearing)))
    return Bearings(2 * min(144, math.ceil(widest / STEP_RAD)), STEP_RAD)


def pixel_step_rad(directions: Floats) -> float:
    """Angle between neighbouring pixels in the middle of the image, along the columns."""
    height, width = directions.shape[:2]
    if height < 2:
        return math.pi
    middle = directions[height // 2 - 1 : height // 2 + 1, width // 2].astype(np.float64)
    angle = float(np.linalg.norm(middle[1] - middle[0]))
    return angle if math.isfinite(angle) and angle > 0 else math.radians(0.25)


def polar_view(
    directions: Floats,
    up_cam: ArrayLike,
    forward_cam: ArrayLike = OPTICAL_AXIS,
    bearings: Bearings | None = None,
    row_step_rad: float | None = None,
) -> PolarView:
    """Sort the pixels below the horizon into cells of bearing and depression.

    Args:
        directions: (h, w, 3) unit rays, optical frame; NaN where not valid.
        up_cam: (3,) unit, the floor's normal (for a level floor the world's up).
        forward_cam: (3,) bearing zero; the optical axis, or the body's forward axis in the optical frame.
        bearings: 72 sectors of 1.25 degrees if left out.
        row_step_rad: height of a row; the angle between pixels if left out.

    Raises:
        ValueError: `forward_cam` is vertical.
    """
    bearings = bearings or Bearings()
    step = row_step_rad or pixel_step_rad(directions)
    bearing, depression = directions_to_polar(directions, up_cam, forward_cam)
    sector = np.floor(bearing / np.float32(bearings.step_rad) + np.float32(bearings.count / 2))
    row = np.floor(depression / np.float32(step))
    inside = (sector >= 0) & (sector < bearings.count) & (row >= 0)
    rows = max(MIN_ROWS, int(row[inside].max()) + 1 if inside.any() else 0)
    outside = bearings.count * rows
    with np.errstate(invalid="ignore"):
        cell = np.where(inside, sector * rows + row, outside).astype(np.int32)
    pixels = np.bincount(cell.ravel(), minlength=outside + 1)[:outside]
    shaped = pixels.reshape(bearings.count, rows).astype(np.float32)
    return PolarView(bearings, cell, rows, step, shaped)
