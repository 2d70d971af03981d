"""The threshold that is chosen by what a teacher says, against an independent reference."""

import json

import numpy as np
import pytest
from sklearn.metrics import roc_curve
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.schemas.metrics import Metrics
from horizon_dl.uncertainty.taught_threshold import FALSE_POSITIVE_WEIGHT, TaughtThreshold


def taught_threshold(frames) -> float | None:
    threshold = TaughtThreshold()
    for entropy, p_obstacle in frames:
        threshold.update(entropy, p_obstacle)
    return threshold.compute()


@pytest.mark.parametrize("seed", range(5))
def test_it_is_the_weighted_youdens_point_of_scikit_learns_curve(seed):
    rng = np.random.default_rng(seed)
    p = rng.random(4000)
    entropy = (0.6 * p + 0.4 * rng.random(4000)).clip(0, 1)
    entropy[::50] = np.nan
    found = taught_threshold([(entropy[:1500], p[:1500]), (entropy[1500:], p[1500:])])
    entropy, p = entropy[~np.isnan(entropy)], p[~np.isnan(entropy)]
    # Every pixel twice: as an obstacle with the teacher's probability for weight, as floor with the rest.
    kinds, weights = np.repeat([True, False], len(p)), np.concatenate([p, 1 - p])
    fpr, tpr, _ = roc_curve(kinds, np.tile(entropy, 2), sample_weight=weights)
    said = entropy > found
    gain = np.average(said, weights=p) - FALSE_POSITIVE_WEIGHT * np.average(said, weights=1 - p)
    assert gain == pytest.approx((tpr - FALSE_POSITIVE_WEIGHT * fpr).max(), abs=2e-3)


def test_a_teacher_that_knows_one_kind_gives_none():
    assert taught_threshold([(np.array([0.3, 0.5]), np.array([1.0, 1.0]))]) is None
    assert taught_threshold([(np.array([0.3, 0.5]), np.array([0.0, 0.0]))]) is None
    assert taught_threshold([(np.array([0.3, 0.5]), np.array([0.7, 0.7]))]) is None
    assert taught_threshold([]) is None
    upside_down = np.linspace(0, 1, 101)
    assert taught_threshold([(upside_down, 1 - upside_down)]) is None
    assert taught_threshold([(np.full(4, 0.5), np.array([0.0, 0.1, 0.8, 0.9]))]) is None
    assert taught_threshold([(np.full(3, np.nan), np.array([0.0, 0.9, 0.5]))]) is None


@pytest.mark.parametrize("most", [0.1, 0.29, 0.45])
def test_a_floor_without_an_obstacle_gives_none(most):
    """A teacher that doubts some of a bare floor a little says nothing of where obstacles begin."""
    rng = np.random.default_rng(0)
    p = rng.random(5000) * most
    entropy = (p + 0.1 * rng.random(5000)).clip(0, 1)
    assert taught_threshold([(entropy, p)]) is None
    assert taught_threshold([(1 - entropy, 1 - p)]) is None


def test_an_accumulator_keeps_it_like_the_papers():
    found = MethodAccumulator(threshold=0.25, simulated_threshold=0.5)
    again, joined = MethodAccumulator(), MethodAccumulator()
    again.load(found.state())
    joined.merge(found)
    joined.merge(MethodAccumulator(threshold=0.75))
    for one in (again, joined):
        assert (one.threshold, one.simulated_threshold) == (0.25, 0.5)
    again.load(MethodAccumulator().state())
    assert (again.threshold, again.simulated_threshold) == (None, None)


FEW = ["--train.rounds", "[3, 3]", "--train.batch", "2", "--train.crop", "32"]


def test_compare_train_and_evaluate_state_it_beside_the_papers(tmp_path):
    data = write_toy_set(tmp_path / "set", frames=24)
    few = ["--seed", "1", *FEW]
    assert main(["compare", str(data), "--out", str(tmp_path / "cmp"), "--seeds", "2", *few]) == 0
    assert main(["train", str(data), "--out", str(tmp_path / "run"), *few]) == 0
    assert main(["evaluate", str(tmp_path / "run"), str(data), "--out", str(tmp_path / "eva")]) == 0
    run = json.loads((tmp_path / "run" / "run.json").read_text())
    for folder in ("cmp", "eva"):
        path = tmp_path / folder / "metrics.json"
        Metrics.read(path)
        net = json.loads(path.read_text())["methods"]["cnn"]
        assert net["operating_point"]["rule"] == "percentile-25"
        point = net["operating_point_simulated"]
        assert point["rule"] == "youden-simulated"
        assert 0 <= point["fpr"] <= 1
        assert 0 <= point["tpr"] <= 1
        if folder == "eva":
            assert point["threshold"] == pytest.approx(run["simulated_threshold"])
        assert "youden-simulated" in (tmp_path / folder / "report.html").read_text()
