from dataclasses import replace

import numpy as np
import pytest

from horizon_dl.data.frame import Frame, RangeImage
from horizon_dl.geometry.camera import Camera
from horizon_dl.metrics.obstacle_height import CROSSING, LOW, UNKNOWN, by_height, obstacle_kinds
from horizon_dl.metrics.scored_pixels import scored_pixels
from horizon_dl.readers.registry import open_recording

HEIGHT, WIDTH = 20, 640
ELEVATION = np.broadcast_to(np.linspace(0.19, -0.19, HEIGHT, dtype=np.float32)[:, None], (HEIGHT, WIDTH))
BELOW = ELEVATION < 0


def scene():
    """From left to right: wall, car before a wall, car before nothing; floor under all, a gap of unknown."""
    truth = np.full((HEIGHT, WIDTH), 1, np.uint8)
    range_m = np.full((HEIGHT, WIDTH), 4.0, np.float32)
    truth[:15, :200], range_m[:15, :200] = 2, 20.0
    truth[:15, 200:400], range_m[:15, 200:400] = 2, 20.0
    range_m[11:15, 200:400] = 10.0
    truth[:11, 400:600], range_m[:11, 400:600] = 0, np.nan
    truth[11:15, 400:600], range_m[11:15, 400:600] = 2, 10.0
    truth[:15, 600:], range_m[:15, 600:] = 2, np.nan
    return truth, range_m


def test_only_what_reaches_the_camera_height_crosses():
    truth, range_m = scene()
    kinds = obstacle_kinds(truth, range_m, ELEVATION)
    assert (kinds[:15, :200] == CROSSING).all()
    assert (kinds[:11, 200:400] == CROSSING).all()
    assert (kinds[11:15, 200:600] == LOW).all()
    assert (kinds[truth != 2] == UNKNOWN).all()
    assert (kinds[:, 600:] == UNKNOWN).all()


def reference_kinds(truth, range_m, elevation_rad):
    """Column by column, thing by thing."""
    kinds = np.zeros(truth.shape, np.uint8)
    for strip in range(320):
        columns = np.flatnonzero(np.arange(WIDTH) * 320 // WIDTH == strip)
        points = [
            (range_m[v, u], elevation_rad[v, u], v, u)
            for u in columns
            for v in range(HEIGHT)
            if truth[v, u] == 2 and not np.isnan(range_m[v, u])
        ]
        thing = []
        for point in [*sorted(points), (1e9, 0.0, 0, 0)]:
            if thing and point[0] - thing[-1][0] > max(0.3, 0.05 * point[0]):
                crosses = max(p[1] for p in thing) >= 0
                for _, _, v, u in thing:
                    kinds[v, u] = CROSSING if crosses else LOW
                thing = []
            thing.append(point)
    return kinds


def test_kinds_against_a_loop_over_things():
    chance = np.random.default_rng(0)
    truth = chance.choice([0, 1, 2], (HEIGHT, WIDTH), p=[0.5, 0.3, 0.2]).astype(np.uint8)
    range_m = chance.uniform(1, 30, (HEIGHT, WIDTH)).astype(np.float32)
    range_m[chance.random((HEIGHT, WIDTH)) < 0.3] = np.nan
    assert np.array_equal(
        obstacle_kinds(truth, range_m, ELEVATION), reference_kinds(truth, range_m, ELEVATION)
    )


def test_a_range_image_of_half_the_size_says_nearly_the_same():
    truth, range_m = scene()
    whole = obstacle_kinds(truth, range_m, ELEVATION)
    half = obstacle_kinds(truth, range_m[1::2, 1::2], ELEVATION[1::2, 1::2])
    assert half.shape == truth.shape
    assert np.mean(half[BELOW] == whole[BELOW]) > 0.8  # all but a row at either end of a thing


def frame_with_ranges() -> Frame:
    truth, range_m = scene()
    camera = Camera("pinhole", WIDTH, HEIGHT, 50.0, 50.0, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    up_cam = np.array([0.0, -1.0, 0.0])
    image, ranges = np.zeros((HEIGHT, WIDTH, 3), np.uint8), RangeImage(range_m.astype(np.float32), "axis")
    return Frame("a", 0.0, up_cam, image=image, camera=camera, truth=truth, ranges=ranges)


def test_parts_hold_all_the_floor_and_one_kind_of_obstacle():
    frame = frame_with_ranges()
    below = scored_pixels(frame)
    parts = by_height(frame, below)
    floor = (~below.obstacle).sum()
    for part in parts.values():
        assert (~part.obstacle).sum() == floor
        assert not (part.mask & ~below.mask).any()
    crossing, low = (parts[name] for name in ("crossing", "low"))
    assert crossing.obstacle.any()
    assert low.obstacle.any()
    assert not (crossing.mask & low.mask & (frame.truth == 2)).any()
    assert not low.mask[:15, :200].any()


@pytest.mark.parametrize("lacking", ["truth", "ranges", "up_cam"])
def test_without_ranges_truth_or_attitude_there_are_no_parts(lacking):
    frame = replace(frame_with_ranges(), **{lacking: None})
    assert by_height(frame, scored_pixels(frame)) == {}


@pytest.mark.real_data
def test_cars_lower_than_the_camera_are_low_on_kitti(data_dir):
    recording = open_recording(data_dir / "kitti")
    frame = recording.read(25)
    below = scored_pixels(frame)
    parts = by_height(frame, below)
    shares = {name: part.obstacle.sum() / below.obstacle.sum() for name, part in parts.items()}
    assert shares["crossing"] + shares["low"] == pytest.approx(1.0)  # every label has a measurement
    assert 0.05 < shares["low"] < 0.6
