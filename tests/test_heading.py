"""Free headings and the temporal filter, against plain geometry and loops."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from horizon_dl.geometry.polar import Bearings
from horizon_dl.ranging.heading import free_heading, swath_m
from horizon_dl.ranging.sectors import FreeDistances, Outcome, no_distances
from horizon_dl.ranging.temporal_filter import SectorFilter

BEARINGS = Bearings(31, math.radians(2.0))
CENTRES = BEARINGS.centres_rad


def sectors(metres: list[float] | np.ndarray, height_m: float = 1.0, sd_m: float = 0.0) -> FreeDistances:
    """inf is free, NaN unknown."""
    distance = np.asarray(metres, np.float32)
    outcome = np.where(np.isnan(distance), 0, np.where(np.isinf(distance), 1, 2)).astype(np.uint8)
    depression = np.arctan2(height_m, distance).astype(np.float32)
    sd = np.where(outcome == 2, sd_m, np.nan).astype(np.float32)
    seen = np.ones(len(distance), bool)
    nearest = np.full(len(distance), 0.5, np.float32)
    bearing = BEARINGS.centres_rad[: len(distance)]
    return FreeDistances(bearing, outcome, distance, sd, sd, depression, seen, nearest)


FREE = np.full(31, math.inf)


def test_a_free_view_keeps_the_wanted_heading() -> None:
    heading = free_heading(sectors(FREE), math.radians(4), 0.3, 3.0)
    assert heading is not None
    assert heading.bearing_rad == pytest.approx(math.radians(4), abs=1e-6)
    assert heading.free_m == math.inf


def test_a_pole_is_passed_by_the_vehicles_width() -> None:
    metres = FREE.copy()
    metres[15] = 2.0  # straight ahead
    heading = free_heading(sectors(metres), math.radians(0.5), 0.3, 3.0)
    assert heading is not None
    # The pole must lie at least 0.3 m aside: asin(0.3 / 2) = 8.6 degrees, the next sector is at 10.
    assert math.degrees(heading.bearing_rad) == pytest.approx(10.0, abs=1e-4)


def test_an_obstacle_beyond_the_needed_distance_is_no_matter() -> None:
    heading = free_heading(sectors(np.full(31, 5.0)), 0.0, 0.3, 3.0)
    assert heading is not None
    assert heading.bearing_rad == pytest.approx(0.0, abs=1e-6)
    assert 4.6 < heading.free_m <= 4.7 + 1e-6


def test_none_if_all_is_blocked_or_unknown() -> None:
    assert free_heading(sectors(np.full(31, 1.0)), 0.0, 0.3, 3.0) is None
    assert free_heading(no_distances(CENTRES), 0.0, 0.3, 3.0) is None


def test_a_gap_too_narrow_is_none() -> None:
    metres = np.full(31, 2.0)
    metres[13:18] = math.inf  # 10 degrees at 2 m are 0.35 m
    assert free_heading(sectors(metres), 0.0, 0.3, 3.0) is None
    heading = free_heading(sectors(metres), math.radians(20), 0.15, 3.0)
    assert heading is not None
    assert abs(math.degrees(heading.bearing_rad)) <= 2.01


def test_uncertainty_brings_obstacles_nearer() -> None:
    found = sectors(np.full(31, 4.0), sd_m=1.0)
    assert free_heading(found, 0.0, 0.2, 3.0, sigmas=0.0) is not None
    assert free_heading(found, 0.0, 0.2, 3.0, sigmas=1.0) is None


def test_obstacles_without_metres_block() -> None:
    found = sectors(FREE)
    found.outcome[:], found.distance_m[:] = Outcome.OBSTACLE, math.nan
    assert free_heading(found, 0.0, 0.3, 3.0) is None


@pytest.mark.parametrize(("radius", "needed"), [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0)])
def test_lengths_that_make_no_sense(radius: float, needed: float) -> None:
    with pytest.raises(ValueError, match="needs"):
        free_heading(sectors(FREE), 0.0, radius, needed)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.sampled_from([1.0, 2.0, 4.0, math.inf]), min_size=31, max_size=31), st.floats(0.1, 0.8))
def test_swath_against_stepping_a_disc(metres: list[float], radius: float) -> None:
    # Reference: move a disc in steps of 1 cm and look which obstacle point it covers first.
    free = swath_m(sectors(metres), radius, 3.0)
    points = [
        (d * math.cos(b), d * math.sin(b))
        for d, b in zip(metres, CENTRES.tolist(), strict=True)
        if math.isfinite(d)
    ]
    for heading in (0, 15, 22):
        b = float(CENTRES[heading])
        steps = np.arange(0, 6, 0.01)
        hit = math.inf
        for x, y in points:
            close = np.hypot(steps * math.cos(b) - x, steps * math.sin(b) - y) < radius
            if close.any():
                hit = min(hit, float(steps[close.argmax()]))
        if math.isfinite(hit) and math.isfinite(free[heading]):
            assert free[heading] == pytest.approx(hit, abs=0.03)
        elif math.isfinite(free[heading]):  # the disc only grazes the point between two steps
            depth = max(
                radius - abs(d * math.sin(a - b))
                for d, a in zip(metres, CENTRES, strict=True)
                if math.isfinite(d)
            )
            assert depth < 0.01


def test_one_wrong_frame_of_three_does_not_show() -> None:
    wall, wrong = sectors(np.full(31, 3.0)), sectors(FREE)
    filter_ = SectorFilter(3)
    filter_.add(0.0, 0.0, wall)
    filter_.add(0.1, 0.0, wall)
    fused = filter_.add(0.2, 0.0, wrong)
    np.testing.assert_allclose(fused.distance_m, 3.0)
    assert filter_.delay_s == pytest.approx(0.1)
    assert np.isinf(filter_.add(0.3, 0.0, wrong).distance_m).all()  # one frame late


def test_of_two_frames_the_nearer_counts() -> None:
    filter_ = SectorFilter(3)
    filter_.add(0.0, 0.0, sectors(np.full(31, 2.0)))
    np.testing.assert_allclose(filter_.add(0.1, 0.0, sectors(np.full(31, 3.0))).distance_m, 2.0)


def test_turns_are_undone() -> None:
    # A pole due north. The body turns clockwise by 6 degrees a frame: it moves left by three sectors.
    filter_ = SectorFilter(3)
    for index in range(3):
        metres = FREE.copy()
        metres[15 - 3 * index] = 2.0
        fused = filter_.add(0.1 * index, math.radians(6 * index), sectors(metres))
    assert np.flatnonzero(np.isfinite(fused.distance_m)).tolist() == [9]


def test_yaw_may_wrap() -> None:
    filter_ = SectorFilter(3)
    metres = FREE.copy()
    metres[15] = 2.0
    filter_.add(0.0, math.pi - 0.01, sectors(metres))
    fused = filter_.add(0.1, -math.pi + 0.01, sectors(metres))
    assert np.isfinite(fused.distance_m[15])


def test_old_frames_are_forgotten_and_unknown_stays_unknown() -> None:
    filter_ = SectorFilter(3, max_age_s=0.5)
    filter_.add(0.0, 0.0, sectors(np.full(31, 1.0)))
    filter_.add(0.1, 0.0, sectors(np.full(31, 1.0)))
    assert np.isinf(filter_.add(5.0, 0.0, sectors(FREE)).distance_m).all()
    assert (filter_.add(5.1, 0.0, no_distances(CENTRES)).outcome == Outcome.UNKNOWN).all()


def test_what_was_free_before_a_stall_is_not_free_after_it() -> None:
    filter_ = SectorFilter(3)
    for time_s in (0.0, 0.1, 0.2):
        filter_.add(time_s, 0.0, sectors(FREE))
    np.testing.assert_allclose(filter_.add(0.62, 0.0, sectors(np.full(31, 1.0))).distance_m, 1.0)
    assert filter_.delay_s == 0.0


def test_a_covered_sector_is_never_chosen() -> None:
    far = sectors(np.full(31, 9.0))
    assert free_heading(far, 0.0, 0.3, 2.0) is not None
    assert free_heading(replace(far, contact_seen=np.zeros(31, bool)), 0.0, 0.3, 2.0) is None


@pytest.mark.parametrize("frames", [0, 2, -1])
def test_an_even_number_of_frames_has_no_median(frames: int) -> None:
    with pytest.raises(ValueError, match="odd"):
        SectorFilter(frames)
