"""Drawn ranges: colours at pixels whose place is known from the geometry."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from flat_model import ANY_PLACE
from scene import scene

from horizon_dl.data.frame import Frame
from horizon_dl.evaluation.scoring import ScoredFrame
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import Bearings, polar_view
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.ranging.contact import ContactDetectorParams
from horizon_dl.ranging.free_distance import free_distances
from horizon_dl.ranging.heading import Heading
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import FreeDistances, Outcome, no_distances
from horizon_dl.reporting.comparison_log import prediction_of
from horizon_dl.runtime.ranged import range_frame, ranges_of
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.film_picture import title_of
from horizon_dl.visualization.flown import RANGES_TITLE, ranges_title, unknown_words
from horizon_dl.visualization.panels import PanelRow, frame_panel
from horizon_dl.visualization.range_picture import draw_ranged
from horizon_dl.visualization.ranges import draw_ranges

CAMERA = Camera("pinhole", 320, 240, 300.0, 300.0, 159.5, 119.5)
UP = np.array([0.0, -1.0, 0.0])
DIRECTIONS = camera_rays(CAMERA).directions
WHITE = np.full((240, 320, 3), 255, np.uint8)
# Level camera 1 m up, wall at z = 4 m: its foot is at v = 119.5 + 300 / 4 = 194.5.
WALL = np.arange(240)[:, None] * np.ones((1, 320)) < 194.5


def ranged() -> FreeDistances:
    polar = polar_view(DIRECTIONS, UP, bearings=Bearings(48, math.radians(1.25)))
    return free_distances(WALL, polar, 1.0)


def test_ground_is_green_and_the_wall_is_not() -> None:
    drawn = draw_ranges(WHITE, DIRECTIONS, UP, ranged())
    assert drawn.shape == (240, 320, 3)
    assert (WHITE == 255).all()
    red, green, blue = drawn[232, 150].tolist()
    assert green > red > blue
    assert drawn[150, 150].tolist() == [255, 255, 255]


def test_the_contact_line_is_where_the_wall_meets_the_floor() -> None:
    drawn = draw_ranges(WHITE, DIRECTIONS, UP, ranged()).astype(int)
    coloured = (drawn[..., 0] > 200) & (drawn[..., 1] < 190) & (drawn[..., 2] < 60)
    rows = np.nonzero(coloured[130:, 150])[0] + 130
    assert len(rows) >= 2
    assert abs(rows.mean() - 194.5) < 3


def test_near_is_redder_than_far() -> None:
    found = ranged()
    near = draw_ranges(WHITE, DIRECTIONS, UP, found, far_m=100.0).astype(int)
    far = draw_ranges(WHITE, DIRECTIONS, UP, found, far_m=4.0).astype(int)
    line = slice(192, 198)
    assert near[line, 150, 1].min() < far[line, 150, 1].min()


def test_the_heading_is_a_blue_line_on_the_ground_only() -> None:
    drawn = draw_ranges(WHITE, DIRECTIONS, UP, ranged(), Heading(math.radians(5), 4.0)).astype(int)
    u = round(159.5 + 300 * math.tan(math.radians(5)))
    assert drawn[236, u, 2] - drawn[236, u, 0] > 80
    assert drawn[236, u + 20, 2] < drawn[236, u + 20, 0]
    assert drawn[150, u].tolist() == [255, 255, 255]


def test_unknown_ground_is_grey_and_hatched_with_its_reason() -> None:
    green = np.full_like(WHITE, (90, 200, 60))
    unknown = no_distances(Bearings(48, math.radians(1.25)).centres_rad)
    drawn = draw_ranges(green, DIRECTIONS, UP, unknown).astype(int)
    ground = drawn[130:]
    assert (np.ptp(ground, axis=2) < 15).all()  # no colour is left
    assert len(np.unique(ground[:, :, 0])) == 2  # stripes and what lies between them
    assert (drawn[:110] == green[:110]).all()
    assert (drawn[119] != green[119]).any()
    said = draw_ranges(green, DIRECTIONS, UP, unknown, words="unknown: black").astype(int)
    assert (said[:220] == drawn[:220]).all()
    assert (said[225:] != drawn[225:]).any()


def test_one_unknown_sector_beside_free_ones() -> None:
    found = ranged()
    outcome = found.outcome.copy()
    outcome[24] = Outcome.UNKNOWN
    nan = np.where(outcome == Outcome.UNKNOWN, np.nan, found.depression_rad).astype(np.float32)
    drawn = draw_ranges(WHITE, DIRECTIONS, UP, replace(found, outcome=outcome, depression_rad=nan)).astype(
        int
    )
    unknown, free = drawn[235, 161:165], drawn[235, 150:155]
    assert (np.ptp(unknown, axis=1) < 15).all()
    assert (free[:, 1] > free[:, 2] + 30).all()


def test_metres_are_written_and_the_picture_may_be_smaller() -> None:
    drawn = draw_ranges(WHITE[::2, ::2], DIRECTIONS, UP, ranged())
    assert drawn.shape == (240, 320, 3)
    below_line = drawn[199:214].astype(int)
    assert (below_line.max(axis=2) < 90).sum() > 30  # dark letters


FRAME = Frame("a.png", 0.0, UP, height_m=1.0, image=WHITE, camera=CAMERA)
P_ABOVE = np.where(WALL, 0.5, 0.02).astype(np.float32)


def range_picture(frame: Frame, *said: Any) -> Image | None:
    found = range_frame(frame, *said)
    return None if found is None else draw_ranged(frame.image, said[0], found)


def test_a_frame_is_ranged_and_the_panel_shows_it() -> None:
    drawn = range_picture(FRAME, DIRECTIONS, P_ABOVE, 0.3)
    assert drawn is not None
    coloured = (drawn[..., 0] > 200) & (drawn[..., 1] < 190) & (drawn[..., 2] < 60)
    rows = np.nonzero(coloured[130:, 150])[0] + 130
    assert abs(rows.mean() - 194.5) < 3
    ground = drawn[236, 150:170].astype(int)
    # The wall is 4 m away and 2 m are needed: straight ahead is free.
    assert (ground[:, 2] > ground[:, 0] + 50).any()
    plain = frame_panel(WHITE, -DIRECTIONS[..., 1], [PanelRow("")], cell_width=160)
    with_ranges = frame_panel(WHITE, -DIRECTIONS[..., 1], [PanelRow("", ranges=drawn)], cell_width=160)
    assert with_ranges.shape[1] == plain.shape[1] + 160 + 10


def test_without_attitude_or_height_nothing_is_drawn() -> None:
    assert range_picture(replace(FRAME, up_cam=None), DIRECTIONS, P_ABOVE, 0.3) is None
    assert range_picture(replace(FRAME, up_cam=np.array([0.0, 0.0, 1.0])), DIRECTIONS, P_ABOVE, 0.3) is None
    without = range_frame(replace(FRAME, height_m=None), DIRECTIONS, P_ABOVE, 0.3)
    assert without is not None
    assert not without.has_metres
    found = range_frame(FRAME, DIRECTIONS, P_ABOVE, 0.3)
    assert found is not None
    assert found.has_metres


def test_a_car_needs_more_room_than_a_drone() -> None:
    drone = range_picture(FRAME, DIRECTIONS, P_ABOVE, 0.3)
    car = range_picture(replace(FRAME, floor_up_cam=UP), DIRECTIONS, P_ABOVE, 0.3)
    assert drone is not None
    assert car is not None
    blue = [int((one[200:, :, 2].astype(int) - one[200:, :, 0] > 50).sum()) for one in (drone, car)]
    assert blue[0] > 0 == blue[1]


def test_what_is_drawn_asks_for_the_evidence_that_is_asked_for_in_flight() -> None:
    """A white picture shows nothing: every bearing is unknown, and the picture says why."""
    asked = range_frame(FRAME, DIRECTIONS, P_ABOVE, 0.3, ANY_PLACE)
    assert asked is not None
    assert asked.asked
    assert "overexposed" in asked.doubts
    assert (asked.found.outcome == Outcome.UNKNOWN).all()
    assert unknown_words(asked).startswith("unknown: overexposed")
    assert ranges_title(asked) == RANGES_TITLE
    free_of_doubt = range_frame(FRAME, DIRECTIONS, P_ABOVE, 0.3)
    assert free_of_doubt is not None
    assert unknown_words(free_of_doubt) == ""
    assert "no evidence" in ranges_title(free_of_doubt)


def test_a_comparison_draws_a_method_with_the_evidence_it_would_be_flown_with() -> None:
    frame, prediction = scene()
    found = vars(prediction.measures)
    white = replace(frame, image=np.full_like(frame.image, 255))
    scored = ScoredFrame(white, prediction.view, {"cnn": found}, {"cnn": 0.5}, {"cnn": ANY_PLACE})
    ranges = ranges_of(white, prediction_of(scored, "cnn"))
    assert ranges is not None
    assert "overexposed" in title_of(ranges)


def test_ranging_rules_reach_what_is_drawn() -> None:
    frame, prediction = scene()
    strict = FlightRules(RangingParams(rise=ContactDetectorParams(rise=5.0, certain_p=0.95)))
    usual, never = (ranges_of(frame, replace(prediction, rules=one)) for one in (FlightRules(), strict))
    assert usual is not None
    assert never is not None
    assert (usual.found.outcome == Outcome.OBSTACLE).any()
    assert not (never.found.outcome == Outcome.OBSTACLE).any()
