"""The ground from above: each place has the colour of what is known of its bearing and distance."""

import math

import numpy as np
import pytest

from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.runtime.ranged import DRONE, Ranged
from horizon_dl.visualization.top_view import FREE, GROUND, MET, UNKNOWN, draw_top_view

WIDTH, HEIGHT = 400, 300
REACH_PX = min(HEIGHT * 0.86, WIDTH * 0.62)


def ranged(outcome: int, metres: float) -> Ranged:
    """60 sectors over 60 degrees, all alike."""
    bearings = np.radians(np.arange(-29.5, 30)).astype(np.float32)
    alike = np.full(60, metres, np.float32)
    outcomes, seen = np.full(60, outcome, np.uint8), np.ones(60, bool)
    found = FreeDistances(bearings, outcomes, alike, alike, alike, alike, seen, alike)
    return Ranged(found, None, np.array([0.0, -1.0, 0.0]))


def colour_at(picture, bearing_deg: float, metres: float):
    radius = REACH_PX * metres / DRONE.far_m
    turn = math.radians(bearing_deg)
    u, v = WIDTH / 2 + radius * math.sin(turn), HEIGHT * 0.94 - radius * math.cos(turn)
    return picture[round(v), round(u)].astype(int)


@pytest.mark.parametrize("bearing_deg", [-28.0, -7.5, 0.0, 3.0, 28.0])
@pytest.mark.parametrize("metres", [3.2, 6.0, 9.0])
def test_free_up_to_the_contact_then_nothing(bearing_deg: float, metres: float) -> None:
    picture = draw_top_view(ranged(Outcome.OBSTACLE, metres), WIDTH, HEIGHT)
    assert np.abs(colour_at(picture, bearing_deg, metres - 0.6) - FREE).max() < 30
    assert np.abs(colour_at(picture, bearing_deg, metres) - MET).max() < 60
    assert np.abs(colour_at(picture, bearing_deg, metres + 0.6) - GROUND).max() < 60


def test_unknown_bearings_and_those_of_no_metres_are_not_green() -> None:
    for outcome in (Outcome.UNKNOWN, Outcome.OBSTACLE):
        picture = draw_top_view(ranged(outcome, math.nan), WIDTH, HEIGHT)
        assert np.abs(colour_at(picture, 5.0, 6.0) - UNKNOWN).max() < 10
    free = draw_top_view(ranged(Outcome.FREE, math.nan), WIDTH, HEIGHT)
    assert np.abs(colour_at(free, 5.0, 6.0) - FREE).max() < 10


def test_neighbouring_sectors_leave_no_gap() -> None:
    picture = draw_top_view(ranged(Outcome.FREE, math.inf), WIDTH, HEIGHT)
    along = [colour_at(picture, bearing, 6.0) for bearing in np.linspace(-29, 29, 400)]
    assert np.abs(np.array(along) - FREE).max() < 12
