import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.special import entr
from scipy.stats import entropy as scipy_entropy

from horizon_dl.uncertainty.measures import binary_entropy, measures, p_other_side, surprisal

probabilities = st.floats(0.0, 1.0, width=32)


def exact_entropy(p: np.ndarray) -> np.ndarray:
    p = np.asarray(p, np.float64)
    return (entr(p) + entr(1.0 - p)) / np.log(2.0)


def test_measures_against_float64_formulas():
    rng = np.random.default_rng(0)
    samples = rng.beta(0.3, 0.3, (16, 12, 15)).astype(np.float32)
    above = rng.random((12, 15)) > 0.5
    got = measures(samples, above)
    p = samples.astype(np.float64).mean(axis=0)
    expected_entropy = exact_entropy(samples).mean(axis=0)
    np.testing.assert_allclose(got.p_above, p, atol=1e-6)
    np.testing.assert_allclose(got.entropy, exact_entropy(p), atol=2e-6)
    np.testing.assert_allclose(got.expected_entropy, expected_entropy, atol=2e-6)
    np.testing.assert_allclose(got.mutual_information, exact_entropy(p) - expected_entropy, atol=4e-6)
    np.testing.assert_allclose(got.surprisal, -np.log2(np.where(above, p, 1.0 - p)), rtol=1e-4, atol=1e-5)
    assert all(getattr(got, name).dtype == np.float32 for name in got.__dataclass_fields__)


def test_known_numbers():
    np.testing.assert_allclose(binary_entropy([0.0, 0.25, 0.5, 1.0]), [0.0, 0.811278, 1.0, 0.0], atol=1e-6)
    assert scipy_entropy([0.1, 0.9], base=2) == pytest.approx(float(binary_entropy(0.1)), abs=1e-6)
    p = np.array([[0.25, 0.25]], np.float32)
    np.testing.assert_allclose(surprisal(p, np.array([[True, False]])), [[2.0, 0.415037]], atol=1e-6)


def test_two_sure_samples_that_disagree_are_all_mutual_information():
    samples = np.array([[[0.0]], [[1.0]]])
    got = measures(samples, np.array([[False]]))
    assert got.entropy.item() == got.mutual_information.item() == 1.0
    assert got.expected_entropy.item() == 0.0


def test_a_single_pass_has_no_mutual_information():
    samples = np.random.default_rng(1).random((1, 5, 6)).astype(np.float32)
    got = measures(samples, np.ones((5, 6), bool))
    assert not got.mutual_information.any()
    np.testing.assert_array_equal(got.entropy, got.expected_entropy)


@given(arrays(np.float32, (4, 2, 3), elements=probabilities), arrays(np.bool_, (2, 3)))
def test_ranges_and_order_hold_everywhere(samples, above):
    got = measures(samples, above)
    assert (got.mutual_information >= 0).all()
    assert (got.mutual_information <= got.entropy + 1e-6).all()
    assert (got.expected_entropy <= got.entropy + 1e-5).all()  # Jensen
    for values in (got.entropy, got.expected_entropy):
        assert ((values >= 0) & (values <= 1)).all()
    assert np.isfinite(got.surprisal).all()
    assert (got.surprisal >= 0).all()


@given(probabilities)
def test_entropy_is_symmetric_and_exact_at_the_ends(p):
    assert float(binary_entropy(p)) == pytest.approx(float(exact_entropy(np.float32(p))), abs=2e-6)
    assert float(binary_entropy(p)) == pytest.approx(float(binary_entropy(1.0 - p)), abs=2e-6)


def test_ruled_out_sides_stay_finite_and_sure_ones_cost_nothing():
    p = np.array([[0.0, 1.0, 0.0, 1.0]], np.float32)
    above = np.array([[True, False, False, True]])
    np.testing.assert_array_equal(surprisal(p, above), [[126.0, 126.0, 0.0, 0.0]])
    assert not np.signbit(surprisal(p, above)).any()


def test_p_other_side_is_the_bounded_surprisal():
    rng = np.random.default_rng(2)
    p, above = rng.random((8, 8)).astype(np.float32), rng.random((8, 8)) > 0.5
    np.testing.assert_allclose(p_other_side(p, above), 1.0 - 2.0 ** -surprisal(p, above), atol=1e-6)


def test_half_precision_samples_are_taken_in_full():
    samples = np.random.default_rng(3).random((20, 4, 4)).astype(np.float16)
    exact = samples.astype(np.float64).mean(axis=0)
    np.testing.assert_allclose(measures(samples, np.ones((4, 4), bool)).p_above, exact, atol=1e-6)


@pytest.mark.parametrize("shape", [(4, 4), (0, 4, 4), (2, 4, 5)])
def test_shapes_that_do_not_fit_are_refused(shape):
    with pytest.raises(ValueError, match="do not fit"):
        measures(np.full(shape, 0.5), np.ones((4, 4), bool))
