import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from horizon_dl.uncertainty.threshold import PaperThreshold, paper_threshold


@given(
    arrays(np.float32, st.integers(50, 400), elements=st.floats(0, 1, width=32)),
    st.floats(1, 99),
)
def test_the_percentile_lies_between_those_of_numpy(scores, percentile):
    everywhere = np.ones(len(scores), bool)
    found = paper_threshold([(scores[:20], everywhere[:20]), (scores[20:], everywhere[20:])], percentile)
    low = np.percentile(scores, percentile, method="lower")
    high = np.percentile(scores, percentile, method="higher")
    assert low - 2 / 4096 <= found <= high + 2 / 4096


def test_missing_values_and_unlabelled_pixels_do_not_count():
    threshold = PaperThreshold(50)
    scores = np.array([np.nan, 0.2, 0.2, 0.2, 0.9, 0.9, 0.9, 0.9])
    threshold.update(scores, np.array([True] * 4 + [False] * 4))
    assert threshold.compute() == pytest.approx(0.2, abs=1e-3)
    assert PaperThreshold(50).compute() == 0.0


def test_a_merged_threshold_is_that_of_all_and_a_state_goes_on():
    rng = np.random.default_rng(0)
    parts, everywhere = rng.random((3, 100)), np.ones(100, bool)
    whole, merged = PaperThreshold(25), PaperThreshold(25)
    for part in parts:
        whole.update(part, everywhere)
        one = PaperThreshold(25)
        one.update(part, everywhere)
        merged.merge(one)
    again = PaperThreshold(25)
    again.load(merged.state())
    assert whole.compute() == merged.compute() == again.compute()
