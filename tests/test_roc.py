import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from sklearn.metrics import average_precision_score, precision_recall_curve, roc_auc_score, roc_curve

from horizon_dl.metrics.roc import RocAccumulator, score_bin

RNG = np.random.default_rng(0)
N = 20_000
POSITIVE = RNG.random(N) < 0.3
DEPRESSION = np.deg2rad(RNG.uniform(0.0, 60.0, N))
NOISE = RNG.normal(size=N)


def sigmoid(x: np.ndarray) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-x))


SCORES = {
    "random": RNG.random(N),
    "separable": sigmoid(NOISE + 2.0 * POSITIVE),
    "reversed": sigmoid(NOISE - 1.0 * POSITIVE),
    "tied": np.round(sigmoid(NOISE + POSITIVE), 1),
    "saturated high": (1.0 - 10.0 ** -(4.0 + 0.4 * NOISE + 0.5 * POSITIVE)).clip(0, 1).astype(np.float32),
    "saturated low": 10.0 ** -(9.0 + NOISE - POSITIVE),
    "ends": (NOISE + POSITIVE > 0.5).astype(np.float64),
    "constant": np.full(N, 0.4),
}


def filled(score, positive=POSITIVE, depression=DEPRESSION) -> RocAccumulator:
    roc = RocAccumulator()
    roc.update(score, positive, depression)
    return roc


@pytest.mark.parametrize("name", SCORES)
def test_figures_are_those_of_sklearn(name):
    score = SCORES[name]
    got = filled(score).compute()
    assert got.auc == pytest.approx(roc_auc_score(POSITIVE, score), abs=1e-3)
    assert got.ap == pytest.approx(average_precision_score(POSITIVE, score), abs=1e-3)
    precision, recall, _ = precision_recall_curve(POSITIVE, score)
    f1 = 2 * precision * recall / np.maximum(precision + recall, 1e-12)
    assert got.best_f1 == pytest.approx(f1.max(), abs=1e-3)
    fpr, tpr, _ = roc_curve(POSITIVE, score, drop_intermediate=False)
    # Pixels in one bin count as tied: at a steep place of the curve that moves the rate.
    assert got.fpr90 == pytest.approx(fpr[np.argmax(tpr >= 0.90)], abs=3e-3)
    assert got.fpr95 == pytest.approx(fpr[np.argmax(tpr >= 0.95)], abs=1e-3)
    assert (got.positives, got.negatives) == (POSITIVE.sum(), (~POSITIVE).sum())


def pairs_by_hand(score: np.ndarray, positive: np.ndarray, band: np.ndarray) -> float:
    right = pairs = 0.0
    for b in np.unique(band):
        obstacle, floor = score[positive & (band == b)], score[~positive & (band == b)]
        difference = obstacle[:, None] - floor[None]
        right += (difference > 0).sum() + 0.5 * (difference == 0).sum()
        pairs += difference.size
    return right / pairs


@pytest.mark.parametrize("name", SCORES)
def test_auc_within_depression_counts_pairs_of_a_band(name):
    score, positive, depression = SCORES[name][:3000], POSITIVE[:3000], DEPRESSION[:3000]
    expected = pairs_by_hand(score, positive, np.floor(np.rad2deg(depression)))
    got = filled(score, positive, depression).compute().auc_within_depression
    assert got == pytest.approx(expected, abs=1e-3)


def test_position_alone_earns_nothing_within_bands():
    depression = np.deg2rad(np.repeat(np.arange(60), 100) + 0.5)
    positive = RNG.random(6000) < np.linspace(0.95, 0.05, 6000)
    got = filled(1.0 - depression / (np.pi / 2), positive, depression).compute()
    assert got.auc > 0.8
    assert got.auc_within_depression == pytest.approx(0.5, abs=1e-9)


def test_chunks_and_merged_parts_give_the_same_as_all_at_once():
    score = SCORES["separable"]
    whole, first, second = filled(score), RocAccumulator(), RocAccumulator()
    for start in range(0, N, 4000):
        chunk = slice(start, start + 4000)
        target = first if start < 8000 else second
        target.update(score[chunk], POSITIVE[chunk], DEPRESSION[chunk])
    first.merge(second)
    assert first.compute() == whole.compute()


def test_curve_runs_from_corner_to_corner_and_holds_the_area():
    roc = filled(SCORES["separable"])
    fpr, tpr = roc.curve()
    assert (fpr[0], tpr[0], fpr[-1], tpr[-1]) == (0.0, 0.0, 1.0, 1.0)
    assert (np.diff(fpr) >= 0).all()
    assert (np.diff(tpr) >= 0).all()
    assert np.trapezoid(tpr, fpr) == pytest.approx(roc.compute().auc, abs=1e-9)


@pytest.mark.parametrize("threshold", [0.0, 0.2, 0.5, 0.9, 1.0])
def test_rates_at_a_threshold(threshold):
    score = SCORES["separable"]
    tpr, fpr = filled(score).rates_at(threshold)
    assert tpr == pytest.approx(np.mean(score[POSITIVE] > threshold), abs=2e-3)
    assert fpr == pytest.approx(np.mean(score[~POSITIVE] > threshold), abs=2e-3)


def test_a_score_equal_to_the_threshold_is_not_over_it():
    assert filled(SCORES["constant"]).rates_at(0.4) == (0.0, 0.0)


def test_missing_classes_give_none():
    empty = RocAccumulator()
    assert empty.compute().auc is None
    assert empty.curve() is None
    assert empty.rates_at(0.5) == (None, None)
    floor_only = filled(np.array([0.2, 0.6]), np.array([False, False]), np.array([0.1, 0.1]))
    result = floor_only.compute()
    assert (result.auc, result.auc_within_depression, result.ap) == (None,) * 3
    assert (result.fpr90, result.fpr95, result.best_f1) == (None,) * 3
    assert (result.positives, result.negatives) == (0, 2)
    assert floor_only.rates_at(0.5) == (None, 0.5)


def test_classes_that_share_no_band_have_no_banded_figure():
    apart = filled(np.array([0.2, 0.6]), np.array([False, True]), np.deg2rad([10.5, 20.5]))
    assert apart.compute().auc == 1.0
    assert apart.compute().auc_within_depression is None


@pytest.mark.parametrize(
    ("score", "depression", "message"),
    [
        ([0.5, np.nan], [0.1, 0.1], "scores"),
        ([0.5, 1.1], [0.1, 0.1], "scores"),
        ([0.5, -0.1], [0.1, 0.1], "scores"),
        ([0.5, 0.5], [0.1, -0.1], "depressions"),
        ([0.5, 0.5], [0.1, np.nan], "depressions"),
        ([0.5, 0.5], [0.1], "one length"),
        ([[0.5, 0.5]], [[0.1, 0.1]], "one length"),
    ],
)
def test_bad_input_is_refused(score, depression, message):
    with pytest.raises(ValueError, match=message):
        RocAccumulator().update(np.array(score), np.ones(np.shape(score), bool), np.array(depression))


def test_straight_down_belongs_to_the_last_band():
    got = filled(np.array([0.2, 0.6]), np.array([False, True]), np.array([np.pi / 2, np.deg2rad(89.5)]))
    assert got.compute().auc_within_depression == 1.0


@given(arrays(np.float32, 30, elements=st.floats(0.0, 1.0, width=32)))
def test_bins_keep_the_order(score):
    ordered = np.sort(score)
    assert (np.diff(score_bin(ordered)) >= 0).all()


@settings(max_examples=50)
@given(
    arrays(np.int64, 40, elements=st.integers(0, 10)),
    arrays(np.bool_, 40),
    arrays(np.int64, 40, elements=st.integers(0, 3)),
)
def test_any_coarse_score_is_counted_exactly(tenths, positive, band):
    score = tenths / 10.0
    got = filled(score, positive, np.deg2rad(band + 0.5)).compute()
    if positive.any() and not positive.all():
        assert got.auc == pytest.approx(roc_auc_score(positive, score), abs=1e-12)
    if got.auc_within_depression is not None:
        assert got.auc_within_depression == pytest.approx(pairs_by_hand(score, positive, band), abs=1e-12)


def test_memory_does_not_grow():
    roc = filled(SCORES["random"])
    before = roc.counts.nbytes
    for _ in range(5):
        roc.update(SCORES["random"], POSITIVE, DEPRESSION)
    assert roc.counts.nbytes == before
    assert roc.compute().positives == 6 * POSITIVE.sum()
