"""Drawn ranges: colours at pixels whose place is known from the geometry."""

import math
from dataclasses import replace

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import Bearings, polar_view
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.ranging.free_distance import FreeDistances, free_distances, no_distances
from horizon_dl.ranging.heading import Heading
from horizon_dl.runtime.ranged import range_frame
from horizon_dl.visualization.panels import PanelRow, frame_panel
from horizon_dl.visualization.range_picture import range_picture
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


def test_unknown_leaves_the_picture_but_for_the_horizon() -> None:
    drawn = draw_ranges(WHITE, DIRECTIONS, UP, no_distances(Bearings(8, 0.1).centres_rad))
    assert (drawn[130:] == 255).all()
    assert (drawn[119] != 255).any()


def test_metres_are_written_and_the_picture_may_be_smaller() -> None:
    drawn = draw_ranges(WHITE[::2, ::2], DIRECTIONS, UP, ranged())
    assert drawn.shape == (240, 320, 3)
    below_line = drawn[199:214].astype(int)
    assert (below_line.max(axis=2) < 90).sum() > 30  # dark letters


FRAME = Frame("a.png", 0.0, UP, height_m=1.0, image=WHITE, camera=CAMERA)
P_ABOVE = np.where(WALL, 0.5, 0.02).astype(np.float32)


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
