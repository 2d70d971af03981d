"""The ground seen from above: what is free, what is met and where to go, as a fan of bearings."""

import math

import numpy as np
from PIL import Image as PilImage
from PIL import ImageDraw

from horizon_dl.ranging.sectors import Outcome
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

    Where no metres are known, bearings with an obstacle are marked at the rim, and their ground is not green.
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
    sectors = zip(bearings.tolist(), found.outcome.tolist(), found.distance_m.tolist(), strict=True)
    for bearing, outcome, metres in sectors:
        shown_m = metres if math.isfinite(metres) else far_m
        radius = reach if outcome == Outcome.UNKNOWN else reach * min(1.0, shown_m / far_m)
        # A sector is so narrow that its arc is straight; the next one begins where it ends.
        rim = [_point(centre, radius, bearing + turn) for turn in (-half, half)]
        somewhere = outcome == Outcome.OBSTACLE and not ranges.has_metres
        draw.polygon((centre, *rim), fill=UNKNOWN if outcome == Outcome.UNKNOWN or somewhere else FREE)
        if outcome == Outcome.OBSTACLE and shown_m <= far_m:
            draw.line(rim, fill=MET, width=4 * _FINER)


def _point(centre: tuple[float, float], radius: float, bearing_rad: float) -> tuple[float, float]:
    return centre[0] + radius * math.sin(bearing_rad), centre[1] - radius * math.cos(bearing_rad)


def _box(centre: tuple[float, float], radius: float) -> tuple[float, float, float, float]:
    return centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius
