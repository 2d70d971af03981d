import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from horizon_dl.metrics.calibration_error import Reliability


def reference_error(p, above, bins):
    """Guo et al. 2017, eq. 3, bin by bin."""
    error = 0.0
    for number in range(bins):
        low, high = number / bins, (number + 1) / bins
        inside = (p >= low) & ((p < high) | (number == bins - 1))
        if inside.any():
            error += inside.sum() / len(p) * abs(p[inside].mean() - above[inside].mean())
    return error


@given(st.integers(0, 1000), st.integers(1, 300), st.sampled_from([1, 4, 16]))
def test_error_is_that_of_numpy_however_it_is_streamed(seed, count, bins):
    chance = np.random.default_rng(seed)
    p = (chance.integers(0, 257, count) / 256).astype(np.float32)  # exact, on borders of bins, too
    above = chance.random(count) < p**2
    whole, parts = Reliability(bins), [Reliability(bins), Reliability(bins)]
    whole.update(p, above)
    for part, chosen in zip(parts, (slice(None, count // 3), slice(count // 3, None)), strict=True):
        part.update(p[chosen], above[chosen])
    parts[0].merge(parts[1])
    assert whole.compute() == pytest.approx(reference_error(p.astype(float), above, bins), abs=1e-9)
    assert parts[0].compute() == pytest.approx(whole.compute(), abs=1e-12)
    assert parts[0].curve()[2].sum() == count


def test_right_probabilities_have_little_error_and_sharper_ones_more():
    chance = np.random.default_rng(0)
    p = chance.random(200_000)
    above = chance.random(200_000) < p
    errors = []
    for power in (1.0, 2.0):
        odds = (p / (1 - p)) ** power
        calibration = Reliability()
        calibration.update(odds / (1 + odds), above)
        errors.append(calibration.compute())
    assert errors[0] < 0.01
    assert errors[1] > 0.05


def test_nothing_counted_has_no_error():
    assert Reliability().compute() is None
