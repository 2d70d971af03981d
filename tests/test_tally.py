import numpy as np
import pytest

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View
from horizon_dl.geometry.camera import Camera
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metrics import mean_and_spread, method_metrics
from horizon_dl.metrics.scored_pixels import Confusion, ScoredPixels, enlarged, scored_pixels

CAMERA = Camera("pinhole", 8, 8, 8.0, 8.0, 3.5, 3.5)


def frame_with(truth):
    image = np.zeros((8, 8, 3), np.uint8)
    return Frame("a", 0.0, np.array([0.0, -1.0, 0.0]), image=image, camera=CAMERA, truth=truth)


def test_only_labelled_pixels_below_the_horizon_are_scored():
    truth = np.full((8, 8), 1, np.uint8)
    truth[:, 0] = 2
    truth[:, 1] = 3
    truth[:, 2] = 0
    pixels = scored_pixels(frame_with(truth))
    assert pixels.mask.sum() == 4 * 6  # the lower four rows, without ceiling and ignored columns
    assert not pixels.mask[:4].any()
    assert pixels.obstacle.sum() == 4
    lowest = np.rad2deg(pixels.depression_rad).max()
    assert lowest == pytest.approx(np.rad2deg(np.arctan(3.5 / 8)), abs=0.8)


def test_a_frame_without_truth_or_attitude_is_not_scored():
    assert not scored_pixels(frame_with(None)).mask.any()
    assert not scored_pixels(frame_with(None), above=True).mask.any()


def test_above_the_horizon_obstacles_stand_against_ceiling_and_sky():
    truth = np.full((8, 8), 3, np.uint8)
    truth[:, 0] = 2
    truth[:, 1] = 1
    truth[:, 2] = 0
    pixels = scored_pixels(frame_with(truth), above=True)
    assert pixels.mask.sum() == 4 * 6  # the upper four rows, without floor and ignored columns
    assert not pixels.mask[4:].any()
    assert pixels.obstacle.sum() == 4
    assert pixels.depression_rad.min() > 0
    highest = np.rad2deg(pixels.depression_rad).max()
    assert highest == pytest.approx(np.rad2deg(np.arctan(3.5 / 8)), abs=0.8)


def test_kept_pixels_keep_their_order():
    truth = np.array([[1, 2] * 4] * 8, np.uint8)
    pixels = scored_pixels(frame_with(truth))
    floor = pixels.keep(~pixels.obstacle)
    assert np.array_equal(floor.mask, pixels.mask & (truth == 1))
    assert not floor.obstacle.any()
    assert np.array_equal(floor.depression_rad, pixels.depression_rad[~pixels.obstacle])


def test_enlarging_keeps_a_constant_and_the_range():
    assert np.allclose(enlarged(np.full((3, 4), 0.3, np.float32), (9, 12)), 0.3, atol=1e-6)


def test_confusion_against_counting_by_hand():
    pixels = ScoredPixels(
        np.ones((2, 2), bool), np.array([True, True, False, False]), np.zeros(4, np.float32)
    )
    confusion = Confusion()
    confusion.update(np.array([[True, False], [True, False]]), pixels)
    assert confusion.compute() == (0.5, 0.5)
    assert Confusion().compute() == (None, None)


def test_sides_ignore_the_band_and_pixels_without_ray():
    elevation = np.array([[0.5, 0.001, -0.5, np.nan]], np.float32)
    view = View(np.zeros((1, 4, 3), np.uint8), elevation)
    accumulator = MethodAccumulator()
    accumulator.add_sides(view, np.array([[0.9, 0.1, 0.9, 0.9]], np.float32), band_rad=0.01)
    assert (accumulator.right_sides, accumulator.sides) == (1, 2)


def test_mean_and_spread_are_those_of_numpy():
    values = [0.1, 0.4, 0.35]
    found = mean_and_spread("auc", values)
    assert found["auc"] == pytest.approx(np.mean(values))
    assert found["auc_sd"] == pytest.approx(np.std(values, ddof=1))
    assert mean_and_spread("auc", [None]) == {"auc": None, "auc_sd": None}
    assert mean_and_spread("auc", [0.5]) == {"auc": 0.5, "auc_sd": 0.0}


def test_method_metrics_have_the_agreed_keys():
    pixels = ScoredPixels(np.ones((1, 2), bool), np.array([True, False]), np.full(2, 0.1, np.float32))
    accumulator = MethodAccumulator(threshold=0.5)
    score = np.array([[0.9, 0.1]], np.float32)
    accumulator.add_scores({"p_above": score, "entropy": score}, pixels)
    accumulator.add_obstacle_map(score, 0.5, pixels)
    block = method_metrics([accumulator], "percentile-25")
    assert set(block["scores"]) == {"entropy"}
    assert block["scores"]["entropy"]["auc"] == 1.0
    figures = {"auc", "auc_within_depression", "ap", "fpr95", "best_f1", "auc_sd"}
    assert set(block["scores"]["entropy"]) >= figures
    point = block["operating_point"]
    assert (point["threshold"], point["tpr"], point["fpr"], point["rule"]) == (0.5, 1.0, 0.0, "percentile-25")
    assert point["tpr_filtered"] == 0.0  # a lone pixel is filtered away


def test_other_pixels_have_figures_of_their_own():
    """Above the horizon the score is wrong on purpose, below it is right."""
    truth = np.array([[3, 2] * 4] * 4 + [[1, 2] * 4] * 4, np.uint8)
    frame = frame_with(truth)
    score = np.where(truth == 2, 0.9, 0.1).astype(np.float32)
    score[:4] = 1.0 - score[:4]
    nothing = scored_pixels(frame_with(None))
    others = {"above": scored_pixels(frame, above=True), "low": nothing}
    accumulators = [MethodAccumulator(), MethodAccumulator()]
    for accumulator in accumulators:
        accumulator.add_scores({"entropy": score, "p_above": score}, scored_pixels(frame), others)
    block = method_metrics(accumulators, "none")
    assert block["scores"]["entropy"]["auc"] == 1.0
    assert block["above"]["scores"]["entropy"]["auc"] == 0.0
    assert block["above"]["scores"]["entropy"]["auc_within_depression"] == 0.0
    assert (block["above"]["obstacles"], block["above"]["others"]) == (16, 16)
    assert "low" not in block
    assert set(block["above"]["scores"]) == set(block["scores"])


def test_pixels_of_one_class_only_give_no_figures():
    frame = frame_with(np.full((8, 8), 2, np.uint8))
    accumulator = MethodAccumulator()
    accumulator.add_scores(
        {"entropy": np.full((8, 8), 0.5, np.float32)},
        scored_pixels(frame),
        {"above": scored_pixels(frame, above=True)},
    )
    assert "above" not in method_metrics([accumulator], "none")


def test_calibration_error_of_the_metrics_is_outside_the_band():
    elevation = np.array([[0.5, 0.5, 0.001, -0.5, np.nan]], np.float32)
    view = View(np.zeros((1, 5, 3), np.uint8), elevation)
    accumulator = MethodAccumulator()
    accumulator.add_sides(view, np.array([[0.9, 0.7, 0.0, 0.2, 0.5]], np.float32), band_rad=0.01)
    block = method_metrics([accumulator], "none")
    assert block["calibration"]["ece"] == pytest.approx((0.1 + 0.3 + 0.2) / 3, abs=1e-6)
    assert block["calibration"]["ece_sd"] == 0.0
    assert "calibration" not in method_metrics([MethodAccumulator()], "none")
