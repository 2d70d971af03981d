"""The horizon, its sides, obstacles and truths drawn over an image, for any lens."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Truth
from horizon_dl.visualization.colours import (
    ABOVE_COLOUR,
    BELOW_COLOUR,
    HORIZON_COLOUR,
    OBSTACLE_COLOUR,
    TRUTH_COLOURS,
    Colour,
    Image,
    grey,
    tint,
)

Floats = NDArray[np.floating]
Stroke = tuple[NDArray[np.intp], NDArray[np.float32], Colour]  # flat places, alpha (n, 1), colour


def contour_coverage(field: Floats, level: float, width_px: float) -> NDArray[np.float32]:
    """Share in [0, 1] of each pixel that a line along `field == level` covers; 0 where the field is NaN.

    The distance to the line is taken to first order, |field - level| / |gradient|, which is exact enough
    for elevations (smooth over a pixel) and needs neither a straight horizon nor a contour follower.
    """
    if min(field.shape) < 2:
        return np.zeros(field.shape, np.float32)
    values = np.asarray(field, np.float32) - np.float32(level)
    along_v, along_u = np.gradient(values)
    slope = np.hypot(along_u, along_v)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance_px = np.abs(values) / slope
    coverage = np.clip(width_px / 2 + 0.5 - distance_px, 0.0, 1.0)
    return np.asarray(np.nan_to_num(coverage))


def draw_line(image: Image, coverage: Floats, colour: Colour, strength: float = 1.0) -> Image:
    """A copy of the (h, w, 3) image with a colour laid over it by (h, w) coverage times strength."""
    return draw_strokes(image, [stroke(coverage, colour, strength)])


def stroke(coverage: Floats, colour: Colour, strength: float = 1.0) -> Stroke:
    """A line that can be drawn into many pictures: few pixels of a picture lie on it."""
    place = np.flatnonzero(coverage)
    return place, np.asarray(coverage.ravel()[place, None] * strength, np.float32), colour


def draw_strokes(image: Image, strokes: Sequence[Stroke]) -> Image:
    """A copy of the (h, w, 3) image with lines drawn into it."""
    drawn = image.copy()
    flat = drawn.reshape(-1, 3)
    for place, alpha, colour in strokes:
        mixed = flat[place] * (1.0 - alpha) + np.asarray(colour, np.float32) * alpha
        flat[place] = mixed.round().astype(np.uint8)
    return drawn


def horizon_strokes(elevation: Floats, width_px: float = 1.5) -> list[Stroke]:
    """The horizon as `draw_horizon` draws it."""
    # A wider dark line underneath keeps the yellow visible on bright walls and skies.
    return [
        stroke(contour_coverage(elevation, 0.0, width_px + 1.5), (0, 0, 0), 0.45),
        stroke(contour_coverage(elevation, 0.0, width_px), HORIZON_COLOUR),
    ]


def draw_horizon(image: Image, elevation: Floats, band_rad: float = 0.0, width_px: float = 1.5) -> Image:
    """The image with the horizon as a thin yellow line and, if asked for, the edges of the ignored band.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        band_rad: half width of the ignored band; 0 draws none.
        width_px: width of the horizon line.
    """
    drawn = image
    if band_rad > 0:
        for edge_rad in (-band_rad, band_rad):
            drawn = draw_line(drawn, contour_coverage(elevation, edge_rad, 1.0), (255, 255, 255), 0.55)
    return draw_strokes(drawn, horizon_strokes(elevation, width_px))


def draw_sides(image: Image, elevation: Floats, band_rad: float, strength: float = 0.22) -> Image:
    """The image tinted by the horizon label: blue above, green below, not in the band, and the horizon.

    Shapes and units as in `draw_horizon`.
    """
    known = np.where(np.isnan(elevation), 0.0, elevation)
    tinted = tint(image, known > max(band_rad, 1e-12), ABOVE_COLOUR, strength)
    tinted = tint(tinted, known < -max(band_rad, 1e-12), BELOW_COLOUR, strength)
    return draw_horizon(tinted, elevation, band_rad)


def draw_obstacles(image: Image, obstacles: NDArray[np.bool_], strength: float = 0.75) -> Image:
    """The image without colour, the pixels of the (h, w) obstacle map in orange red."""
    return tint(grey(image), obstacles, OBSTACLE_COLOUR, strength)


def draw_truth(image: Image, truth: NDArray[np.uint8], strength: float = 0.7) -> Image:
    """The image without colour, labelled pixels coloured: floor green, obstacle orange red, above blue."""
    drawn = grey(image)
    for value, colour in TRUTH_COLOURS.items():
        drawn = tint(drawn, truth == value, colour, strength)
    return drawn


def shrink_truth(truth: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
    """A (H, W) truth at another size, (height, width), keeping the points of sparse truths (lidar).

    Where several labelled pixels fall into one, the obstacle wins, then above, then floor. Enlarging takes
    the nearest pixel.
    """
    full_height, full_width = truth.shape
    rows = np.arange(height) * full_height // height
    columns = np.arange(width) * full_width // width
    if height >= full_height or width >= full_width:
        return truth[np.ix_(rows, columns)]
    shrunk = np.zeros((height, width), np.uint8)
    for value in (Truth.FLOOR, Truth.ABOVE, Truth.OBSTACLE):
        v, u = np.nonzero(truth == value)
        shrunk[v * height // full_height, u * width // full_width] = value
    return shrunk
