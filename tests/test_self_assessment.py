"""What a net says of itself without labels."""

import numpy as np
import pytest

from horizon_dl.evidence.self_assessment import SelfAssessment, said, verdict


def test_the_share_is_that_of_the_pixels_below() -> None:
    rng = np.random.default_rng(0)
    assessment, below, called = SelfAssessment(), 0, 0
    for _ in range(3):
        p_above, elevation = rng.random((8, 9)), rng.uniform(-1, 1, (8, 9))
        elevation[0, 0] = np.nan
        assessment.update(p_above, elevation)
        below += int(np.sum(elevation < 0))
        called += int(np.sum((p_above < 0.5) & (elevation < 0)))
    assert assessment.compute()["sure_below"] == pytest.approx(called / below)


@pytest.mark.parametrize(
    ("share", "word"),
    [(0.68, "ok"), (0.94, "doubtful"), (0.99, "not to be trusted"), (None, "not to be trusted")],
)
def test_the_verdict_in_words(share: float | None, word: str) -> None:
    assert verdict(share) == word
    line = said({"sure_below": share, "verdict": word})
    assert (line is None) == (word == "ok")
    assert line is None or line.startswith(word)


def test_before_any_pixel_nothing_is_trusted() -> None:
    assert SelfAssessment().compute() == {"sure_below": None, "verdict": "not to be trusted"}
    assert said(None) is None
