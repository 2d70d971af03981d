"""What is lower than the vehicle does not block its way, and what is as high does."""

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from horizon_dl.cli import main
from horizon_dl.cli.options import vehicle_height
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import Bearings, polar_view
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.ranging.free_distance import free_distances, free_distances_from_p
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.ranging.usual_levels import UsualLevels
from horizon_dl.ranging.vehicle_height import CAMERA_ALONE, VehicleHeight
from horizon_dl.simulation.embedded import embedded_set

CAMERA = Camera("pinhole", 320, 240, 200.0, 200.0, 159.5, 119.5)
HEIGHT_M = 1.0
UP = up_in_camera(quaternion_from_rpy(0.0, math.radians(-12), 0.0), (0.0, 0.0, 0.0))
DIRECTIONS = camera_rays(CAMERA).directions
POLAR = polar_view(DIRECTIONS, UP, bearings=Bearings(30, math.radians(2.0)))
MIDDLE = np.abs(POLAR.bearings.centres_rad) < math.radians(20)


def ring(distance_m: float, thing_m: float) -> NDArray[np.bool_]:
    """A wall all around, `thing_m` high: by the ray's height where it meets the wall."""
    sine = DIRECTIONS.astype(np.float64) @ UP
    meets_m = HEIGHT_M + distance_m * sine / np.sqrt(1 - sine**2)
    return np.asarray((meets_m >= 0) & (meets_m <= thing_m))


def outcome(found: FreeDistances) -> NDArray[np.uint8]:
    return found.outcome[MIDDLE]


@given(st.floats(1.5, 3.5), st.floats(0.1, 1.6), st.floats(0.0, 0.9))
def test_a_thing_blocks_if_it_is_as_high_as_the_vehicles_lowest_part(
    distance_m: float, thing_m: float, below_m: float
) -> None:
    """Against plain heights; in the margin, 2 degrees and a row, either is right."""
    margin_m = distance_m * math.tan(math.radians(2.5) + POLAR.row_step_rad)
    found = free_distances(ring(distance_m, thing_m), POLAR, HEIGHT_M, vehicle=VehicleHeight(below_m, 0.0))
    if thing_m >= HEIGHT_M - below_m:
        assert (outcome(found) == Outcome.OBSTACLE).all()
        np.testing.assert_allclose(found.distance_m[MIDDLE], distance_m, rtol=0.08)
    elif thing_m < HEIGHT_M - below_m - margin_m:
        assert (outcome(found) == Outcome.FREE).all()


def found_of(camera_deg: float, obstacle_of: Any, vehicle: VehicleHeight | None) -> tuple[Any, FreeDistances]:
    """By p_above, of a camera 1 m over the floor that looks so far down."""
    up = up_in_camera(quaternion_from_rpy(0.0, math.radians(-camera_deg), 0.0), (0.0, 0.0, 0.0))
    polar = polar_view(DIRECTIONS, up, bearings=Bearings(30, math.radians(2.0)))
    p_above = np.where(obstacle_of(up), 0.6, 0.03).astype(np.float32)
    return polar, free_distances_from_p(p_above, polar, HEIGHT_M, usual=UsualLevels(0.1), vehicle=vehicle)


def wall(distance_m: float, thing_m: float) -> Any:
    def seen_from(up: NDArray[np.float64]) -> NDArray[np.bool_]:
        sine = DIRECTIONS.astype(np.float64) @ up
        meets_m = HEIGHT_M + distance_m * sine / np.sqrt(1 - sine**2)
        return np.asarray((meets_m >= 0) & (meets_m <= thing_m))

    return seen_from


@pytest.mark.parametrize(
    ("camera_deg", "distance_m", "thing_m", "below_m"),
    [(12, 0.5, 0.85, 0.3), (12, 0.4, 0.95, 0.1), (12, 0.7, 0.75, 0.3), (0, 0.5, 0.8, 0.3)],
)
def test_a_near_thing_whose_foot_is_below_the_picture_blocks(
    camera_deg: float, distance_m: float, thing_m: float, below_m: float
) -> None:
    _, found = found_of(camera_deg, wall(distance_m, thing_m), VehicleHeight(below_m, 0.1))
    assert (outcome(found) == Outcome.OBSTACLE).all()


@pytest.mark.parametrize("below_m", [0.0, 0.3, 0.6])
@pytest.mark.parametrize(("camera_deg", "distance_m"), [(60, 1.0), (45, 0.8), (70, 0.5)])
def test_what_the_pictures_upper_rim_cuts_off_blocks(
    camera_deg: float, distance_m: float, below_m: float
) -> None:
    _, found = found_of(camera_deg, wall(distance_m, 3.0), VehicleHeight(below_m, 0.1))
    _, without = found_of(camera_deg, wall(distance_m, 3.0), None)
    blocked_without = without.outcome == Outcome.OBSTACLE
    assert blocked_without.sum() > 10
    assert (found.outcome[blocked_without] == Outcome.OBSTACLE).all()


@pytest.mark.parametrize("below_m", [0.0, 0.2, 0.5])
def test_behind_a_low_thing_a_high_one_is_found(below_m: float) -> None:
    both = ring(1.8, 0.2) | ring(4.0, 2.0)
    p_above = np.where(both, 0.6, 0.03).astype(np.float32)
    found = free_distances_from_p(
        p_above, POLAR, HEIGHT_M, usual=UsualLevels(0.1), vehicle=VehicleHeight(below_m, 0.0)
    )
    np.testing.assert_allclose(found.distance_m[MIDDLE], 4.0, rtol=0.1)


def test_a_vehicle_that_stands_on_the_floor_is_blocked_by_all() -> None:
    low = ring(2.0, 0.1)
    for vehicle in (None, VehicleHeight(HEIGHT_M, 0.0), VehicleHeight(5.0, 1.0)):
        assert (outcome(free_distances(low, POLAR, HEIGHT_M, vehicle=vehicle)) == Outcome.OBSTACLE).all()


@pytest.mark.parametrize("height_m", [None, 0.0, -1.0, math.nan])
def test_without_a_height_nothing_is_passed_over_but_what_misses_the_horizon(height_m: float | None) -> None:
    low = ring(2.0, 0.1)
    reaching = free_distances(low, POLAR, height_m, vehicle=VehicleHeight(0.3, 0.0))
    assert (outcome(reaching) == Outcome.OBSTACLE).all()
    assert (outcome(free_distances(low, POLAR, height_m, vehicle=CAMERA_ALONE)) == Outcome.FREE).all()


def test_the_answer_is_never_less_careful_for_a_taller_vehicle(subtests: Any) -> None:
    rng = np.random.default_rng(0)
    for trial in range(20):
        obstacle = rng.random((240, 320)) < 0.02
        for _ in range(6):
            v, u = rng.integers(0, 200), rng.integers(0, 280)
            obstacle[v : v + rng.integers(4, 60), u : u + rng.integers(4, 60)] = True
        nearest = [
            blocked(free_distances(obstacle, POLAR, HEIGHT_M, vehicle=VehicleHeight(below, 0.0)))
            for below in (0.0, 0.2, 0.4, 0.8, 1.0)
        ]
        with subtests.test(trial=trial):
            for low, high in pairwise(nearest):
                assert (high <= low).all()


def blocked(found: FreeDistances) -> NDArray[np.float64]:
    """How far each sector is free; unknown ones count as blocked."""
    return np.where(found.outcome == Outcome.UNKNOWN, 0.0, np.nan_to_num(found.distance_m, posinf=1e9))


@pytest.mark.parametrize("text", ["", "1", "1,2,3", "a,b", "-1,0", "0,nan", "inf,0", "0.3;0.1"])
@pytest.mark.parametrize("verb", ["fly", "predict", "evaluate", "compare"])
def test_what_is_no_height_is_one_line(text: str, verb: str, capsys: Any) -> None:
    if verb == "fly":
        arguments = ["fly", "m.onnx", "--source", "x", "--mavlink", "udpout:127.0.0.1:14550"]
    else:
        arguments = [verb, *(["m"] if verb != "compare" else []), "data", "--out", "o"]
    with pytest.raises(SystemExit) as stopped:
        main([*arguments, f"--vehicle-height={text}"])
    assert stopped.value.code == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "BELOW,ABOVE" in line


@pytest.mark.slow
@pytest.mark.long
def test_figures_of_what_is_in_the_way(tmp_path: Path) -> None:
    model = Path(__file__).parent.parent / "exports" / "reference" / "model.onnx"
    arguments = ["evaluate", str(model), str(embedded_set()), "--vehicle-height", "0.3,0.2"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    ranging = json.loads((tmp_path / "out" / "metrics.json").read_text())["ranging"]
    vehicle = ranging["vehicle"]
    assert vehicle["vehicle_height_m"] == [0.3, 0.2]
    assert ranging["vehicle_height_m"] is None
    assert 0 < vehicle["columns"] < ranging["columns"]
    assert vehicle["missed"] <= 0.05


def test_two_lengths_are_read() -> None:
    assert vehicle_height("0.25,1") == VehicleHeight(0.25, 1.0)
    assert vehicle_height("0,0") == CAMERA_ALONE
