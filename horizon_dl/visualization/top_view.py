"""The ground seen from above: what is free, what is met and where to go, as a fan of bearings."""

import math

import numpy as np
from PIL import Image as PilImage
from PIL import ImageDraw

from horizon_dl.ranging.free_distance import Outcome
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.colours import HEADING_COLOUR, Colour, Image
from horizon_dl.visualization.text import font

GROUND: Colour = (30, 33, 39)
RING: Colour = (78, 84, 94)
FREE: Colour = (70, 112, 62)
MET: Colour = (240, 96, 48)
UNKNOWN: Colour = (46, 49, 55)
TEXT: Colour = (196, 202, 212)
_FINER = 2
_RING_PX = 14


def draw_top_view(ranges: Ranged, width: int, height: int) -> Image:
    """(height, width, 3): the vehicle at the lower edge looks up; green is free, orange met, grey unknown.

    Where no metres are known, bearings with an obstacle are marked at the rim.
    """
    canvas = PilImage.new("RGB", (width * _FINER, height * _FINER), GROUND)
    draw = ImageDraw.Draw(canvas)
    centre = (width * _FINER / 2, height * _FINER * 0.94)
    reach = min(height * _FINER * 0.86, width * _FINER * 0.62)
    far_m = ranges.vehicle.far_m
    _draw_sectors(draw, centre, reach, ranges)
    for share in (0.25, 0.5, 0.75, 1.0):
        radius = reach * share
        draw.arc(_box(centre, radius), 180, 360, fill=RING, width=1)
        if ranges.has_metres:
            place = (centre[0] + 4, centre[1] - radius - _RING_PX * _FINER - 2)
            draw.text(place, f"{far_m * share:g} m", font=font(_RING_PX * _FINER * 3 // 4), fill=TEXT)
    if ranges.heading is not None:
        tip = _point(centre, reach * min(1.0, ranges.heading.free_m / far_m), ranges.heading.bearing_rad)
        draw.line((centre, tip), fill=HEADING_COLOUR, width=4 * _FINER)
        draw.ellipse(_box(tip, 5 * _FINER), fill=HEADING_COLOUR)
    nose, left, right = (_point(centre, 11 * _FINER, turn) for turn in (0.0, -2.5, 2.5))
    draw.polygon((nose, right, left), fill=(240, 242, 246))
    return np.asarray(canvas.resize((width, height), PilImage.Resampling.BOX), np.uint8)


def _draw_sectors(
    draw: ImageDraw.ImageDraw, centre: tuple[float, float], reach: float, ranges: Ranged
) -> None:
    found, far_m = ranges.found, ranges.vehicle.far_m
    bearings = found.bearing_rad.astype(np.float64)
    half = (bearings[-1] - bearings[0]) / max(len(bearings) - 1, 1) / 2 if len(bearings) > 1 else 0.02
    for bearing, outcome, metres in zip(bearings, found.outcome, found.distance_m, strict=True):
        start, end = (math.degrees(bearing + turn) - 90 for turn in (-half, half))
        if outcome == Outcome.UNKNOWN:
            draw.pieslice(_box(centre, reach), start, end + 0.3, fill=UNKNOWN)
            continue
        shown_m = float(metres) if math.isfinite(metres) else far_m
        radius = reach * min(1.0, shown_m / far_m)
        draw.pieslice(_box(centre, radius), start, end + 0.3, fill=FREE)
        if outcome == Outcome.OBSTACLE and shown_m <= far_m:
            draw.arc(_box(centre, radius), start, end + 0.3, fill=MET, width=4 * _FINER)


def _point(centre: tuple[float, float], radius: float, bearing_rad: float) -> tuple[float, float]:
    return centre[0] + radius * math.sin(bearing_rad), centre[1] - radius * math.cos(bearing_rad)


def _box(centre: tuple[float, float], radius: float) -> tuple[float, float, float, float]:
    return centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius
