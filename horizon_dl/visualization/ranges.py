"""What is flown, drawn into a picture for any lens: free, blocked and unknown bearings, and the heading."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.polar import directions_to_polar, pixel_step_rad
from horizon_dl.ranging.heading import Heading
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.visualization.cells import resize_image
from horizon_dl.visualization.colours import (
    BELOW_COLOUR,
    HEADING_COLOUR,
    HORIZON_COLOUR,
    OBSTACLE_COLOUR,
    UNKNOWN_COLOUR,
    Image,
    grey,
    tint,
)
from horizon_dl.visualization.overlays import draw_horizon
from horizon_dl.visualization.text import paste, shorten, text_image, text_size

Floats = NDArray[np.floating]

FAR_M = 10.0
LABEL_PX = 12
LABEL_GAP_PX = 14
HATCH_PX = 9
_BANDS = 6


def draw_ranges(
    image: Image,
    directions: NDArray[np.float32],
    up_cam: NDArray[np.float64],
    found: FreeDistances,
    heading: Heading | None = None,
    *,
    forward_cam: NDArray[np.float64] | tuple[float, float, float] = (0.0, 0.0, 1.0),
    far_m: float = FAR_M,
    words: str = "",
) -> Image:
    """The picture with free ground in green, contacts from red (near) to yellow (far), the heading in blue.

    A contact that lies below the picture is drawn at its lower edge with `<` before its metres. The ground of
    sectors that are unknown is grey and hatched.

    Args:
        image: (h, w, 3) uint8 RGB.
        directions: (H, W, 3) unit rays of the picture at any size of its aspect, NaN where not valid; the
            drawing has this size.
        up_cam: (3,) unit, the floor's normal in the optical frame.
        found: the sectors.
        heading: drawn as a line on the ground; None draws none.
        forward_cam: (3,) what bearing zero means, as for the sectors.
        far_m: this far is yellow.
        words: written at the lower edge, such as why sectors are unknown.
    """
    height, width = directions.shape[:2]
    bearing, depression = directions_to_polar(directions, up_cam, forward_cam)
    drawn = image if image.shape[:2] == (height, width) else resize_image(image, width, height)
    sector = _sector_of(bearing, found)
    contact = _by_pixel(found.depression_rad, sector, math.nan)
    with np.errstate(invalid="ignore"):
        ground = (depression > 0) & (depression > contact)
    drawn = tint(drawn, ground, BELOW_COLOUR, 0.35)
    unknown = (depression > 0) & (_by_pixel(found.outcome, sector, Outcome.FREE) == Outcome.UNKNOWN)
    drawn = draw_horizon(_hatched(drawn, unknown), -depression)
    line_rad = 1.5 * pixel_step_rad(directions)
    edge = np.abs(depression - contact) < line_rad
    drawn = _draw_contacts(drawn, edge, sector, found, far_m)
    if heading is not None:
        off = np.abs(bearing - heading.bearing_rad) * np.cos(depression)
        drawn = tint(drawn, (off < 1.5 * line_rad) & ground, HEADING_COLOUR, 0.95)
    drawn = _with_labels(drawn, edge, sector, found)
    if words:
        label = text_image(shorten(words, LABEL_PX, width), LABEL_PX)
        paste(drawn, label, height - label.shape[0], 0)
    return drawn


def _hatched(image: Image, mask: NDArray[np.bool_]) -> Image:
    """The masked pixels without colour under diagonal stripes."""
    v, u = np.indices(mask.shape)
    stripes = mask & ((u + v) % HATCH_PX < HATCH_PX // 3)
    drawn = np.where(mask[..., None], grey(image), image).astype(np.uint8)
    return tint(tint(drawn, mask, UNKNOWN_COLOUR, 0.35), stripes, UNKNOWN_COLOUR, 0.6)


def _sector_of(bearing: Floats, found: FreeDistances) -> NDArray[np.int64]:
    """(h, w) the sector of each pixel, -1 for none."""
    centres = found.bearing_rad.astype(np.float64)
    if len(centres) < 2:
        return np.full(bearing.shape, -1)
    step = (centres[-1] - centres[0]) / (len(centres) - 1)
    index = np.floor(np.nan_to_num(bearing, nan=math.inf) / step - centres[0] / step + 0.5)
    return np.where((index >= 0) & (index < len(centres)), index, -1).astype(np.int64)


def _by_pixel(values: NDArray[Any], sector: NDArray[np.int64], outside: float) -> NDArray[Any]:
    return np.where(sector >= 0, values[np.maximum(sector, 0)], outside)


def _draw_contacts(
    image: Image, edge: NDArray[np.bool_], sector: NDArray[np.int64], found: FreeDistances, far_m: float
) -> Image:
    met = _by_pixel(found.outcome, sector, 0) == Outcome.OBSTACLE
    metres = np.nan_to_num(_by_pixel(found.distance_m, sector, 0.0), nan=0.0, posinf=far_m)
    band = np.clip(metres / far_m * _BANDS, 0, _BANDS - 1).astype(np.int64)
    share = (np.arange(_BANDS) / (_BANDS - 1))[:, None]
    near, far = np.array(OBSTACLE_COLOUR), np.array(HORIZON_COLOUR)
    colours = (near + share * (far - near)).round().astype(np.uint8)
    drawn, shown = image.copy(), edge & met
    drawn[shown] = colours[band[shown]]
    return drawn


def _with_labels(
    image: Image, edge: NDArray[np.bool_], sector: NDArray[np.int64], found: FreeDistances
) -> Image:
    """Metres under some contacts, as many as fit side by side."""
    drawn = image.copy()
    lined_v, lined_u = np.nonzero(edge)
    lined = sector[lined_v, lined_u]
    right_px = -LABEL_GAP_PX
    for index in np.flatnonzero((found.outcome == Outcome.OBSTACLE) & np.isfinite(found.distance_m)).tolist():
        u, v = lined_u[lined == index], lined_v[lined == index]
        if not len(u):
            continue
        text = ("" if found.contact_seen[index] else "<") + f"{found.distance_m[index]:.1f}"
        label_width, label_height = text_size(text, LABEL_PX)
        left = int(np.mean(u)) - label_width // 2
        if left < max(0, right_px + LABEL_GAP_PX) or left + label_width > drawn.shape[1]:
            continue
        top = min(int(np.max(v)) + 3, drawn.shape[0] - label_height)
        paste(drawn, text_image(text, LABEL_PX), max(0, top), left)
        right_px = left + label_width
    return drawn
