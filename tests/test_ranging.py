"""Ranging against floors and walls whose distances are known from their geometry."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import Bearings, directions_to_polar, level_axes, polar_view
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.ranging.contact import ContactDetectorParams, first_contact, first_rise
from horizon_dl.ranging.deviation import distance_sd
from horizon_dl.ranging.free_distance import free_distances, free_distances_from_p
from horizon_dl.ranging.in_the_way import connected_to_top
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import FreeDistances, Outcome, no_distances
from horizon_dl.ranging.usual_levels import LEAST_CONTRAST, MOST_CONTRAST, USUAL_CONTRAST, UsualLevels
from horizon_dl.ranging.vehicle_height import CAMERA_ALONE
from horizon_dl.uncertainty.measures import p_of_entropy

PINHOLE = Camera("pinhole", 160, 120, 120.0, 120.0, 79.5, 59.5)
RADTAN = Camera("radtan", 160, 120, 120.0, 118.0, 81.0, 60.0, (-0.25, 0.06, 0.001, -0.001, 0.0))
FISHEYE = Camera("kannala_brandt", 160, 120, 90.0, 90.0, 79.5, 59.5, (0.01, -0.01, 0.004, -0.001))
BEARINGS = Bearings(30, math.radians(2.0))


def up_of(roll_deg: float, pitch_deg: float) -> NDArray[np.float64]:
    q = quaternion_from_rpy(math.radians(roll_deg), math.radians(pitch_deg), 0.3)
    return up_in_camera(q, (0.0, 0.0, 0.0))


def wall_map(
    directions: NDArray[np.float32], up: NDArray[np.float64], height_m: float, distance_m: float
) -> NDArray[np.bool_]:
    """A cylinder wall around the camera: every pixel whose floor point is farther, or above the horizon."""
    sine = directions.astype(np.float64) @ up
    with np.errstate(divide="ignore", invalid="ignore"):
        floor_m = height_m * np.sqrt(1 - sine**2) / -sine
    return (sine >= 0) | (floor_m > distance_m)


@pytest.mark.parametrize("camera", [PINHOLE, RADTAN, FISHEYE])
@pytest.mark.parametrize(("roll", "pitch"), [(0, -10), (25, -15), (-40, -20)])
def test_a_wall_all_around_is_equally_far_on_every_bearing(camera: Camera, roll: float, pitch: float) -> None:
    directions, up = camera_rays(camera).directions, up_of(roll, pitch)
    polar = polar_view(directions, up, bearings=BEARINGS)
    found = free_distances(wall_map(directions, up, 1.2, 4.0), polar, 1.2)
    seen = found.nearest_rad > math.atan(1.2 / 4.0) + math.radians(2)
    assert seen.sum() >= 8
    assert (found.outcome[seen] == Outcome.OBSTACLE).all()
    assert found.contact_seen[seen].all()
    np.testing.assert_allclose(found.distance_m[seen], 4.0, rtol=0.05)
    assert (np.abs(found.distance_m[seen] - 4.0) < 2 * found.sd_m[seen]).all()


@pytest.mark.parametrize("pitch", [-45, -60])
def test_free_is_no_farther_than_the_camera_sees(pitch: float) -> None:
    """A camera that looks down sees floor alone, in front of a wall at 12 m that is out of its view."""
    directions, up = camera_rays(PINHOLE).directions, up_of(0, pitch)
    polar = polar_view(directions, up, bearings=BEARINGS)
    wall = wall_map(directions, up, 1.5, 12.0)
    assert not wall.any()
    p = np.full(wall.shape, 0.1, np.float32)
    top_m = 1.5 / math.tan(math.radians(-pitch) - math.atan(60 / 120))  # straight ahead, by hand
    for found in (
        free_distances(wall, polar, 1.5),
        free_distances_from_p(p, polar, 1.5, usual=UsualLevels(0.15)),
    ):
        ahead = np.abs(found.bearing_rad) < math.radians(1.5)
        assert (found.outcome[ahead] == Outcome.FREE).all()
        np.testing.assert_allclose(found.distance_m[ahead], top_m, rtol=0.03)
        assert (found.distance_m[found.outcome == Outcome.FREE] < 12.0).all()
    assert np.isnan(free_distances(wall, polar, None).distance_m).all()


def test_bearings_are_vertical_planes_and_grow_clockwise() -> None:
    # Hand-computed: camera rolled by 90 degrees (right side down): image "right" is the world's down.
    up = np.array([-1.0, 0.0, 0.0])
    bearing, depression = directions_to_polar(np.array([[0.6, 0.0, 0.8], [0.0, -0.6, 0.8]], np.float32), up)
    np.testing.assert_allclose(bearing, [0.0, math.atan2(0.6, 0.8)], atol=1e-6)
    np.testing.assert_allclose(depression, [math.asin(0.6), 0.0], atol=1e-6)


@settings(deadline=None, max_examples=40)
@given(st.floats(-60, 60), st.floats(-50, 50), st.floats(-170, 170), st.floats(-80, 80))
def test_polar_angles_undo_a_direction_built_from_them(
    roll: float, pitch: float, bearing_deg: float, depression_deg: float
) -> None:
    up = up_of(roll, pitch)
    ahead, right, _ = level_axes(up, (0.0, 0.0, 1.0)).astype(np.float64)
    b, a = math.radians(bearing_deg), math.radians(depression_deg)
    ray = math.cos(a) * (math.cos(b) * ahead + math.sin(b) * right) - math.sin(a) * up
    bearing, depression = directions_to_polar(ray[None].astype(np.float32), up)
    assert bearing[0] == pytest.approx(b, abs=1e-5)
    assert depression[0] == pytest.approx(a, abs=1e-4)


def test_bearing_zero_can_be_the_bodys_forward_axis() -> None:
    # The camera looks 30 degrees to the right of the body: its middle is at bearing +30.
    forward = (-math.sin(math.radians(30)), 0.0, math.cos(math.radians(30)))
    bearing, _ = directions_to_polar(np.array([[0.0, 0.0, 1.0]], np.float32), (0.0, -1.0, 0.0), forward)
    assert math.degrees(bearing[0]) == pytest.approx(30, abs=1e-4)


def test_a_vertical_bearing_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="vertical"):
        level_axes((0.0, 0.0, -1.0), (0.0, 0.0, 1.0))


def test_every_pixel_below_the_horizon_in_reach_is_counted_once() -> None:
    directions, up = camera_rays(RADTAN).directions, up_of(10, -12)
    polar = polar_view(directions, up, bearings=BEARINGS)
    bearing, depression = directions_to_polar(directions, up)
    inside = (np.abs(bearing) < math.radians(30)) & (depression >= 0)
    assert polar.pixels.sum() == pytest.approx(inside.sum(), abs=2)
    np.testing.assert_array_equal(polar.counts(np.ones(directions.shape[:2], bool)), polar.pixels)


def test_free_and_unknown_are_kept_apart() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -10)
    polar = polar_view(directions, up, bearings=Bearings(72, math.radians(5)))
    found = free_distances(np.zeros((120, 160), bool), polar, 1.0)
    inside = np.abs(found.bearing_rad) < math.radians(30)
    assert (found.outcome[inside] == Outcome.FREE).all()
    assert np.isinf(found.distance_m[inside]).all()
    outside = np.abs(found.bearing_rad) > math.radians(40)
    assert (found.outcome[outside] == Outcome.UNKNOWN).all()
    assert np.isnan(found.distance_m[outside]).all()
    assert np.isnan(found.sd_m[inside | outside]).all()


def test_a_camera_that_looks_up_knows_nothing() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, 60)
    found = free_distances(np.zeros((120, 160), bool), polar_view(directions, up), 1.0)
    assert (found.outcome == Outcome.UNKNOWN).all()


@pytest.mark.parametrize("height", [None, 0.0, -1.0])
def test_without_height_there_are_bearings_but_no_metres(height: float | None) -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -10)
    polar = polar_view(directions, up, bearings=BEARINGS)
    found = free_distances(wall_map(directions, up, 1.0, 3.0), polar, height)
    met = found.outcome == Outcome.OBSTACLE
    assert met.sum() > 20
    assert np.isnan(found.distance_m[met]).all()
    np.testing.assert_allclose(found.depression_rad[met], math.atan(1 / 3), atol=math.radians(0.6))


def test_specks_are_passed_and_gaps_bridged() -> None:
    obstacle = np.zeros((3, 40), bool)
    obstacle[:, :20] = True
    obstacle[0, 30] = True  # a speck on the floor
    obstacle[1, 17:19] = False  # a gap in the obstacle
    contact = first_contact(obstacle, np.ones_like(obstacle), window=8, share=0.6)
    assert contact.tolist() == [19, 19, 19]


def test_a_pole_narrower_than_a_sector_is_seen() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -10)
    polar = polar_view(directions, up, bearings=Bearings(20, math.radians(3)))  # six pixels wide
    pole = wall_map(directions, up, 1.0, 3.0)
    pole[:, :82], pole[:, 84:] = False, False
    found = free_distances(pole, polar, 1.0)
    met = np.flatnonzero(found.outcome == Outcome.OBSTACLE)
    assert met.tolist() == [10]
    assert found.distance_m[10] == pytest.approx(3.0, rel=0.05)


def test_cells_without_pixels_say_nothing() -> None:
    obstacle = np.zeros((1, 40), bool)
    seen = np.zeros((1, 40), bool)
    seen[0, ::4] = True  # lines of a lidar
    obstacle[0, :20:4] = True
    assert first_contact(obstacle, seen, window=8, share=0.6).tolist() == [16]


def test_the_contact_lies_between_the_last_ground_and_the_first_obstacle() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -10)
    polar = polar_view(directions, up, bearings=BEARINGS)
    wall = wall_map(directions, up, 1.0, 3.0)
    known = np.zeros_like(wall)
    known[::6] = True
    sparse = free_distances(wall, polar, 1.0, known=known)
    middle = np.abs(sparse.bearing_rad) < math.radians(20)
    assert (sparse.outcome[middle] == Outcome.OBSTACLE).all()
    error = np.abs(sparse.distance_m[middle] - 3.0)
    assert error.max() < 3.0 * 0.15
    assert (error < 2 * sparse.sd_m[middle]).all()


def test_mats_are_obstacles_but_not_connected_ones() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    beyond_2, beyond_3 = (wall_map(directions, up, 1.0, d) for d in (2.0, 3.0))
    wall = wall_map(directions, up, 1.0, 8.0)
    mat = (beyond_2 & ~beyond_3) | wall
    middle = np.abs(polar.bearings.centres_rad) < math.radians(20)
    everything = free_distances(mat, polar, 1.0)
    connected = free_distances(mat, polar, 1.0, vehicle=CAMERA_ALONE)
    np.testing.assert_allclose(everything.distance_m[middle], 2.0, rtol=0.06)
    np.testing.assert_allclose(connected.distance_m[middle], 8.0, rtol=0.12)


def test_connection_may_go_sideways() -> None:
    obstacle = np.zeros((4, 10), bool)
    obstacle[1, 0:6] = True  # a pole up to the horizon
    obstacle[2, 5] = True  # its foot sticks out
    obstacle[3, 8] = True  # a stone
    connected = connected_to_top(obstacle, np.ones_like(obstacle), np.ones(4, np.int64))
    assert connected[2, 5]
    assert not connected[3, 8]
    assert connected.sum() == 7


def test_an_obstacle_at_the_images_edge_is_at_most_that_far() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -10)
    polar = polar_view(directions, up, bearings=BEARINGS)
    found = free_distances(wall_map(directions, up, 1.0, 0.5), polar, 1.0)
    met = found.outcome == Outcome.OBSTACLE
    assert met.sum() > 20
    assert not found.contact_seen[met].any()
    np.testing.assert_allclose(found.distance_m[met], 1.0 / np.tan(found.nearest_rad[met]), rtol=1e-4)


def test_uncertainty_is_the_spread_of_the_formula() -> None:
    # Reference: draw errors and take the standard deviation of the distances.
    rng = np.random.default_rng(0)
    rules = RangingParams(attitude_sd_rad=math.radians(0.5), height_sd=0.03)
    depression = math.atan(1.2 / 5)
    drawn_angles = depression + rng.normal(0, math.hypot(math.radians(0.5), math.radians(0.2)), 200_000)
    drawn = 1.2 * (1 + rng.normal(0, 0.03, 200_000)) / np.tan(drawn_angles)
    sd = distance_sd(np.array([5.0]), 1.2, np.array([math.radians(0.2)]), rules)
    assert sd[0] == pytest.approx(drawn.std(), rel=0.03)


def test_nothing_known_gives_unknown_everywhere() -> None:
    found = no_distances(BEARINGS.centres_rad)
    assert (found.outcome == Outcome.UNKNOWN).all()
    assert np.isnan(found.distance_m).all()
    assert not found.contact_seen.any()


def noisy_p(wall: NDArray[np.bool_], floor: float, obstacle: float, seed: int = 0) -> NDArray[np.float32]:
    rng = np.random.default_rng(seed)
    logit = np.where(wall, math.log(obstacle / (1 - obstacle)), math.log(floor / (1 - floor)))
    return (1 / (1 + np.exp(-logit - rng.normal(0, 0.4, wall.shape)))).astype(np.float32)


@pytest.mark.parametrize(("floor", "obstacle"), [(0.03, 0.12), (0.1, 0.3), (0.2, 0.45)])
def test_the_contact_is_a_rise_over_the_floors_own_level(floor: float, obstacle: float) -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(15, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    p = noisy_p(wall_map(directions, up, 1.2, 4.0), floor, obstacle)
    found = free_distances_from_p(p, polar, 1.2, usual=UsualLevels(0.25))
    inside = found.nearest_rad > math.radians(25)
    assert inside.sum() >= 10
    assert (found.outcome[inside] == Outcome.OBSTACLE).all()
    assert np.median(np.abs(found.distance_m[inside] / 4.0 - 1)) < 0.05


def test_a_map_that_cannot_tell_the_sides_is_an_obstacle_whatever_the_usual_floor_was() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    middle = np.abs(polar.bearings.centres_rad) < math.radians(20)
    for usual in map(UsualLevels, (0.05, 0.3, 0.45)):
        found = free_distances_from_p(np.full((120, 160), 0.5, np.float32), polar, 1.0, usual=usual)
        assert (found.outcome[middle] == Outcome.OBSTACLE).all()


def test_an_even_floor_is_free_and_a_view_full_of_wall_is_not() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    wall = np.ones((120, 160), bool)
    middle = np.abs(polar.bearings.centres_rad) < math.radians(20)
    floor = free_distances_from_p(noisy_p(~wall, 0.1, 0.4), polar, 1.0, usual=UsualLevels(0.15))
    assert (floor.outcome[middle] == Outcome.FREE).mean() > 0.9
    full = free_distances_from_p(noisy_p(wall, 0.1, 0.45), polar, 1.0, usual=UsualLevels(0.15))
    assert (full.outcome[middle] == Outcome.OBSTACLE).all()
    assert not full.contact_seen[middle].any()


def test_a_gap_of_floor_between_walls_is_enough_to_know_the_walls() -> None:
    # As between parked cars: an eighth of the picture is floor, and the rest covers the nearest ground.
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    bearing, _ = directions_to_polar(directions, up)
    wall = np.abs(bearing) > math.radians(5)
    assert 0.1 < 1 - wall.mean() < 0.2
    found = free_distances_from_p(noisy_p(wall, 0.1, 0.4), polar, 1.0)
    aside = np.abs(polar.bearings.centres_rad)
    walls = (aside > math.radians(7)) & (aside < math.radians(25))
    assert (found.outcome[walls] == Outcome.OBSTACLE).all()
    assert not found.contact_seen[walls].any()
    assert (found.outcome[aside < math.radians(3)] == Outcome.FREE).all()


def test_pixels_that_say_nothing_are_left_out() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    found = free_distances_from_p(np.full((120, 160), np.nan, np.float32), polar, 1.0, usual=UsualLevels(0.1))
    assert (found.outcome == Outcome.UNKNOWN).all()


def test_connected_only_passes_a_mat_in_p_above() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    beyond_2, beyond_3, wall = (wall_map(directions, up, 1.0, d) for d in (2.0, 3.0, 8.0))
    p = noisy_p((beyond_2 & ~beyond_3) | wall, 0.08, 0.4)
    middle = np.abs(polar.bearings.centres_rad) < math.radians(20)
    everything = free_distances_from_p(p, polar, 1.0, usual=UsualLevels(0.15))
    connected = free_distances_from_p(p, polar, 1.0, usual=UsualLevels(0.15), vehicle=CAMERA_ALONE)
    assert np.median(everything.distance_m[middle]) == pytest.approx(2.0, rel=0.06)
    assert np.median(connected.distance_m[middle]) == pytest.approx(8.0, rel=0.15)


def test_the_rise_test_against_a_plain_loop() -> None:
    # Reference: Page's test written for one column with ordinary numbers.
    rng = np.random.default_rng(3)
    rules = ContactDetectorParams(rise=0.7, prior_rad=math.radians(3.0))
    logit = (rng.normal(-2, 0.3, (20, 60)) + 1.2 * (np.arange(60) < 25)).astype(np.float32)
    step = math.radians(0.25)
    contact, _, _ = first_rise(logit, np.ones((20, 60), bool), -2.0, step, rules)
    for column in range(20):
        weight, weighted, total, start, expected = rules.prior_rad, -2.0 * rules.prior_rad, 0.0, -1, -1
        for row in range(59, -1, -1):
            floor = weighted / weight
            up = min(max(float(logit[column, row]) - floor - rules.rise, -1.5), 1.5)
            total = max(0.0, total + up * step)
            if total == 0:
                start, weighted, weight = -1, weighted + float(logit[column, row]) * step, weight + step
            elif start < 0:
                start = row
            if total > rules.alarm_rad:
                expected = start
                break
        assert contact[column] == expected
    assert np.abs(np.median(contact) - 24) <= 1


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_the_rise_grows_with_how_far_obstacles_stand_out(floor: float, obstacle: float) -> None:
    usual, rules = UsualLevels(floor, obstacle), ContactDetectorParams()
    assert rules.scaled_to(UsualLevels(floor)) == rules
    assert LEAST_CONTRAST <= usual.contrast <= MOST_CONTRAST
    assert rules.scaled_to(usual).rise == pytest.approx(rules.rise * usual.contrast / USUAL_CONTRAST)
    p, q = (np.clip(one, 0.001, 0.999) for one in (floor, obstacle))
    stands_out = math.log(q * (1 - p) / (p * (1 - q)))  # reference: the log of the odds' ratio
    if LEAST_CONTRAST < stands_out < MOST_CONTRAST:
        assert usual.contrast == pytest.approx(stands_out, abs=1e-6)


def test_what_rises_little_is_no_obstacle_where_obstacles_stand_out() -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    middle = np.abs(polar.bearings.centres_rad) < math.radians(20)
    patch = wall_map(directions, up, 1.2, 2.5) & ~wall_map(directions, up, 1.2, 4.0)
    p = np.where(wall_map(directions, up, 1.2, 4.0), 0.4, np.where(patch, 0.135, 0.08)).astype(np.float32)
    faint = free_distances_from_p(p, polar, 1.2, usual=UsualLevels(0.08, 0.13)).distance_m[middle]
    clear = free_distances_from_p(p, polar, 1.2, usual=UsualLevels(0.08, 0.3)).distance_m[middle]
    np.testing.assert_allclose(np.median(faint), 2.5, rtol=0.06)
    np.testing.assert_allclose(np.median(clear), 4.0, rtol=0.06)


def view_of_a_hall(
    nearest_p: float, floor_p: float, wall_m: float
) -> tuple[NDArray[np.bool_], FreeDistances]:
    """Sectors straight ahead, and what is said of ground that a net doubts at its nearest 1.5 m."""
    directions, up = camera_rays(PINHOLE).directions, up_of(0, -15)
    polar = polar_view(directions, up, bearings=BEARINGS)
    middle = np.abs(polar.bearings.centres_rad) < math.radians(20)
    near = ~wall_map(directions, up, 1.2, 2.9)
    p = np.where(wall_map(directions, up, 1.2, wall_m), 0.45, np.where(near, nearest_p, floor_p))
    return middle, free_distances_from_p(
        p.astype(np.float32), polar, 1.2, usual=UsualLevels(0.05), beyond=True
    )


def test_ground_that_is_doubted_up_to_the_camera_may_be_floor() -> None:
    middle, found = view_of_a_hall(nearest_p=0.2, floor_p=0.1, wall_m=6.0)
    assert not found.contact_seen[middle].any()
    assert (found.distance_m[middle] < 2.6).all()  # the nearest ground in view
    reach = (found.distance_m + 2 * found.sd_beyond_m)[middle]
    assert (reach > 5.7).all()
    assert (reach < 9.0).all()
    assert (found.sd_m[middle] < 0.3 * found.distance_m[middle]).all()


def test_a_wall_that_fills_the_view_is_no_farther_than_it_looks() -> None:
    middle, found = view_of_a_hall(nearest_p=0.45, floor_p=0.45, wall_m=6.0)
    assert not found.contact_seen[middle].any()
    np.testing.assert_array_equal(found.sd_beyond_m[middle], found.sd_m[middle])


@pytest.mark.parametrize("pitch", [-30, -45, -60])
def test_a_view_of_doubt_reaches_no_farther_than_was_looked(pitch: float) -> None:
    directions, up = camera_rays(PINHOLE).directions, up_of(0, pitch)
    polar = polar_view(directions, up, bearings=BEARINGS)
    p = np.full((120, 160), 0.2, np.float32)
    found = free_distances_from_p(p, polar, 1.2, usual=UsualLevels(0.05), beyond=True)
    unasked = free_distances_from_p(p, polar, 1.2, usual=UsualLevels(0.05))
    np.testing.assert_array_equal(unasked.sd_beyond_m, found.sd_m)
    end_m = np.minimum(
        free_distances(np.zeros((120, 160), bool), polar, 1.2).distance_m, 1.2 / math.tan(math.radians(1.0))
    )
    doubted = (found.outcome == Outcome.OBSTACLE) & ~found.contact_seen
    assert doubted.sum() > 10
    reach_m = np.hypot(found.sd_m, (end_m - found.distance_m) / 2)
    np.testing.assert_allclose(found.sd_beyond_m[doubted], reach_m[doubted], rtol=0.1)


def test_a_contact_that_is_seen_has_one_deviation() -> None:
    middle, found = view_of_a_hall(nearest_p=0.05, floor_p=0.05, wall_m=6.0)
    assert found.contact_seen[middle].all()
    np.testing.assert_array_equal(found.sd_beyond_m, found.sd_m)


@pytest.mark.parametrize("p", [0.001, 0.1, 0.3, 0.5])
def test_entropy_is_undone(p: float) -> None:
    entropy = -p * math.log2(p) - (1 - p) * math.log2(1 - p)
    assert p_of_entropy(entropy) == pytest.approx(p, abs=1e-3)
