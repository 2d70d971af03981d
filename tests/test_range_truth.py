"""Measured distances and the block `ranging`."""

import math
from pathlib import Path

import make_sets
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import Frame, RangeImage
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import Bearings
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.metrics.range_truth import (
    level_distance,
    level_ranges,
    nearest,
    true_distances,
    true_obstacles,
)
from horizon_dl.metrics.ranging import RangingAccumulator
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.ranging.usual_levels import UsualLevels
from horizon_dl.readers.registry import open_recording

CAMERA = Camera("pinhole", 160, 120, 120.0, 120.0, 79.5, 59.5)
UP = np.array([0.0, -math.cos(0.2), -math.sin(0.2)])  # the camera looks 0.2 rad down
HEIGHT_M = 1.5


def hall(wall_m: float) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Depth along the axis and labels of a floor that ends at a round wall, in float64."""
    v, u = np.mgrid[0:120, 0:160].astype(np.float64)
    rays = np.stack([(u - 79.5) / 120, (v - 59.5) / 120, np.ones_like(u)], axis=-1)  # z = 1
    up = rays @ UP
    level = np.sqrt((rays**2).sum(-1) - up**2)
    floor_z = np.where(up < 0, -HEIGHT_M / np.minimum(up, -1e-12), np.inf)
    wall_z = wall_m / level
    return np.minimum(floor_z, wall_z), np.where(floor_z < wall_z, 1, 2).astype(np.uint8)


def frame_of(truth: NDArray[np.uint8]) -> Frame:
    return Frame(
        "f",
        0.0,
        UP,
        height_m=HEIGHT_M,
        image=np.zeros((120, 160, 3), np.uint8),
        camera=CAMERA,
        truth=truth,
    )


def test_level_distance_of_depth_and_of_range() -> None:
    depth, labels = hall(5.0)
    directions = camera_rays(CAMERA).directions
    wall = labels == 2
    along_axis = level_distance(RangeImage(depth.astype(np.float32), "axis"), directions, UP)
    np.testing.assert_allclose(along_axis[wall], 5.0, atol=3e-3)
    along = RangeImage((depth / directions[..., 2]).astype(np.float32), "ray")
    along_ray = level_distance(along, directions, UP)
    np.testing.assert_allclose(along_ray[wall], 5.0, atol=6e-3)


def test_zero_and_the_largest_count_mean_nothing_measured(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path)
    (folder / "depth").mkdir()
    counts = np.full((24, 32), 1000, np.uint16)
    counts[0, :2] = (0, 65535)
    Image.fromarray(counts).save(folder / "depth" / "a.png")
    ranges = open_recording(folder).read(0).ranges
    assert ranges is not None
    assert np.isnan(ranges.metres[0, :2]).all()
    assert ranges.metres[5, 5] == pytest.approx(1.0)


def test_true_distance_needs_several_points() -> None:
    depth, labels = hall(5.0)
    directions = camera_rays(CAMERA).directions
    range_m = level_distance(RangeImage(depth.astype(np.float32), "axis"), directions, UP)
    spoiled = range_m.copy()
    row, column = (int(n[len(n) // 2]) for n in np.nonzero((labels == 2) & (np.arange(120)[:, None] > 50)))
    spoiled[row, column] = 1.0  # one stray point
    distances = true_distances(frame_of(labels), spoiled, Bearings(20, math.radians(3)))
    measured = np.isfinite(distances)
    assert measured.sum() >= 18
    np.testing.assert_allclose(distances[measured], 5.0, atol=5e-3)


@pytest.mark.parametrize("as_p", [False, True])
def test_a_perfect_map_ranges_well(as_p: bool) -> None:
    depth, labels = hall(5.0)
    directions = camera_rays(CAMERA).directions
    range_m = level_distance(RangeImage(depth.astype(np.float32), "axis"), directions, UP)
    accumulator = RangingAccumulator(0.7, 25.0)
    found = np.where(labels == 2, 0.5, 0.05).astype(np.float32) if as_p else labels == 2
    accumulator.update(frame_of(labels), found, range_m)
    metrics = accumulator.compute()
    assert metrics["columns"] > 60
    assert metrics["median_relative_error"] < 0.03
    assert (metrics["missed"], metrics["false_stop"], metrics["unknown"]) == (0, 0, 0)


def distances(outcome: list[int], metres: list[float], contact_seen: list[bool]) -> FreeDistances:
    n = len(outcome)
    return FreeDistances(
        np.zeros(n, np.float32),
        np.array(outcome, np.uint8),
        np.array(metres, np.float32),
        np.full(n, 0.5, np.float32),
        np.full(n, 1.0, np.float32),
        np.zeros(n, np.float32),
        np.array(contact_seen),
        np.full(n, math.radians(30), np.float32),
    )


def test_what_counts_as_missed_and_as_false_stop() -> None:
    # Hand-counted. Height 1 m, nearest ground at 30 degrees = 1.73 m.
    inf, nan = math.inf, math.nan
    truth = np.array([4.0, 4.0, 4.0, 4.0, 4.0, 1.0, 1.0, 9.0, nan], np.float32)
    outcome = [2, 2, 2, 1, 0, 2, 1, 2, 2]
    metres = [4.4, 6.1, 2.6, inf, nan, 1.7, inf, 1.0, 1.0]
    accumulator = RangingAccumulator(0.7, 5.0)
    accumulator.count(distances(outcome, metres, [True] * 5 + [False] * 4), truth, 1.0)
    metrics = accumulator.compute()
    assert metrics["columns"] == 7
    assert metrics["missed"] == pytest.approx(3 / 7)  # 6.1 m; free; free before a contact below the view
    assert metrics["false_stop"] == pytest.approx(1 / 7)
    assert metrics["unknown"] == pytest.approx(1 / 7)
    assert metrics["contact_below_view"] == pytest.approx(2 / 7)
    assert metrics["median_relative_error"] == pytest.approx(0.35, rel=1e-5)  # of 0.1, 0.525, 0.35
    assert metrics["within_2sd"] == pytest.approx(2 / 3)  # 0.4 nearer, of 0.5; 1.4 beyond, of 1.0; 2.1 not
    assert metrics["within_2sd_seen"] == pytest.approx(2 / 3)
    assert metrics["contact_seen"] == 1.0
    covered = RangingAccumulator(0.7, 5.0)
    covered.count(distances([2, 2, 2], [2.5, 2.5, 3.9], [False, False, True]), truth[:3], 1.0)
    found = covered.compute()
    assert (found["within_2sd"], found["within_2sd_seen"]) == (1.0, 1.0)
    assert found["contact_seen"] == pytest.approx(1 / 3)


def test_floor_behind_an_obstacle_is_not_free() -> None:
    depth, labels = hall(5.0)
    ranges = RangeImage(depth.astype(np.float32), "axis")
    range_m = level_distance(ranges, camera_rays(CAMERA).directions, UP)
    labels[range_m > 4.0] = 1  # a bumper at 3 to 4 m, and road seen beneath it
    labels[(range_m > 3.0) & (range_m <= 4.0)] = 2
    not_free, known = true_obstacles(frame_of(labels), range_m, Bearings(60, math.radians(2)))
    assert known.all() == np.isfinite(range_m).all()
    assert not_free[range_m > 4.0].all()
    assert not not_free[range_m < 2.9].any()


def test_without_any_measurement_figures_are_null() -> None:
    metrics = RangingAccumulator().compute()
    assert metrics["columns"] == 0
    assert metrics["median_relative_error"] is None
    assert metrics["missed"] is None


def test_the_block_of_a_recording(tmp_path: Path) -> None:
    depth, labels = hall(3.0)
    camera = "model: pinhole\nwidth: 160\nheight: 120\nfx: 120.0\nfy: 120.0\ncx: 79.5\ncy: 59.5\n"
    camera += f"distortion: []\nmount_rpy_deg: [0.0, {math.degrees(-0.2)}, 0.0]\n"
    folder = make_sets.images_csv(tmp_path, ["a.png,0,0,0,0,1.5", "b.png,1,0,0,0,1.5"], camera=camera)
    for name in ("a", "b"):
        make_sets.save_image(folder / f"{name}.png", 160, 120)
    for kind, values in (("labels", labels), ("depth", (depth * 1000).astype(np.uint16))):
        (folder / kind).mkdir()
        Image.fromarray(values).save(folder / kind / "a.png")
    recording = open_recording(folder)
    block = RangingBlock(recording.headers)
    p_above = np.where(labels == 2, 0.4, 0.03).astype(np.float32)
    for index in range(2):  # the second has neither labels nor depth
        block.update(recording.read(index), p_above, usual=UsualLevels(0.1))
    metrics = block.compute()
    assert metrics["interval_m"] == [0.7, 4.0]
    for one in (metrics, metrics["connected"], metrics["true_floor"]):
        assert one["columns"] > 60
        assert one["median_relative_error"] < 0.03
        assert (one["missed"], one["false_stop"]) == (0, 0)
    assert (metrics["connected_only"], metrics["connected"]["connected_only"]) == (False, True)


def test_range_of_a_recording_is_read_in_its_unit(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path)
    (folder / "depth").mkdir()
    Image.fromarray(np.full((12, 16), 2000, np.uint16)).save(folder / "depth" / "b.png")
    make_sets.save_image(folder / "labels" / "b.png", grey=True)
    Image.fromarray(np.ones((24, 32), np.uint8)).save(folder / "labels" / "b.png")
    recording = open_recording(folder)
    assert level_ranges(recording.read(0)) is None
    metres = level_ranges(recording.read(1))
    assert metres is not None
    assert metres.shape == (12, 16)
    # Pitched up by 0.2 rad; the middle ray runs 0.2 rad over the horizon.
    assert metres[5:7, 7:9].mean() == pytest.approx(2.0 * math.cos(0.2), rel=0.01)


def test_a_range_image_of_8_bits_is_left_out(tmp_path: Path) -> None:
    folder = make_sets.images_csv(tmp_path)
    make_sets.save_image(folder / "depth" / "b.png", grey=True)
    assert open_recording(folder).read(1).ranges is None


@pytest.mark.parametrize("upright", [False, True])
def test_ranges_of_a_turned_image_may_be_stored_either_way(tmp_path: Path, upright: bool) -> None:
    camera = "model: pinhole\nwidth: 24\nheight: 32\nfx: 30.0\nfy: 30.0\ncx: 11.5\ncy: 15.5\n"
    folder = make_sets.images_csv(tmp_path, camera=camera + "rotate_image: 90ccw\n")
    (folder / "depth").mkdir()
    metres = np.arange(1, 769, dtype=np.uint16).reshape(32, 24)  # upright
    stored = metres if upright else np.rot90(metres, -1)
    Image.fromarray(np.ascontiguousarray(stored)).save(folder / "depth" / "a.png")
    ranges = open_recording(folder).read(0).ranges
    assert ranges is not None
    np.testing.assert_allclose(ranges.metres, metres * 0.001, rtol=1e-6)


def test_nearest_takes_the_pixel_over_the_centre() -> None:
    image = np.arange(16, dtype=np.uint8).reshape(4, 4)
    assert nearest(image, 2, 2).tolist() == [[5, 7], [13, 15]]


@pytest.mark.real_data
@pytest.mark.parametrize(
    ("name", "interval", "limit"), [("corridor", (0.7, 4.0), 0.07), ("kitti", (5.0, 25.0), 0.06)]
)
def test_ranging_with_the_truths_own_floor(
    data_dir: Path, name: str, interval: tuple[float, float], limit: float
) -> None:
    """Ranging alone, without map errors."""
    recording = open_recording(data_dir / name)
    accumulator = RangingAccumulator(*interval)
    for index in range(5, recording.length, 20):
        frame = recording.read(index)
        range_m = level_ranges(frame)
        assert range_m is not None
        assert frame.truth is not None
        not_floor, known = true_obstacles(frame, range_m, accumulator.bearings)
        accumulator.update(frame, not_floor, range_m, known=known)
    metrics = accumulator.compute()
    assert metrics["columns"] > 50
    assert metrics["median_relative_error"] < limit
    assert metrics["missed"] < 0.03
    assert metrics["false_stop"] < 0.02


def test_outcome_values_are_stable() -> None:
    assert [int(o) for o in Outcome] == [0, 1, 2]
