import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from horizon_dl.uncertainty.percentile import RunningPercentile, stream_percentile


@given(
    arrays(np.float32, st.integers(50, 400), elements=st.floats(0, 1, width=32)),
    st.floats(1, 99),
)
def test_the_percentile_lies_between_those_of_numpy(scores, percentile):
    found = stream_percentile([scores[:20], scores[20:]], percentile)
    low = np.percentile(scores, percentile, method="lower")
    high = np.percentile(scores, percentile, method="higher")
    assert low - 2 / 4096 <= found <= high + 2 / 4096


def test_missing_values_do_not_count():
    scores = RunningPercentile(50)
    scores.add(np.array([np.nan, 0.2, 0.2, 0.2]))
    assert scores.value() == pytest.approx(0.2, abs=1e-3)
    assert RunningPercentile(50).value() == 0.0
