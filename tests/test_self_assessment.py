"""What a net says of itself without labels."""

from dataclasses import replace

import numpy as np
import pytest
from small_run import small_run, toy_set

from horizon_dl.cli import main
from horizon_dl.evidence.self_assessment import SelfAssessment, said, verdict
from horizon_dl.training.run_folder import save_run


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


@pytest.mark.parametrize(
    "damaged", [None, 3, "ok", [], {}, {"verdict": ["x"]}, {"verdict": "fine", "sure_below": 1}]
)
def test_what_is_no_assessment_says_nothing(damaged: object) -> None:
    assert said(damaged) is None


def test_a_damaged_share_costs_the_number_alone() -> None:
    assert said({"verdict": "doubtful", "sure_below": "much"}) == said({"verdict": "doubtful"})


@pytest.mark.parametrize(("share", "told"), [(0.5, False), (0.95, True)])
def test_who_looks_at_predictions_reads_it_too(share, told, tmp_path, capsys) -> None:
    """On the page and in the terminal, of a run and of the file exported from it."""
    run, folder = small_run(), tmp_path / "run"
    folder.mkdir()
    assessment = {"sure_below": share, "verdict": verdict(share)}
    save_run(folder, replace(run, info={**run.info, "self_assessment": assessment}))
    assert main(["export", str(folder), "--out", str(tmp_path / "file"), "-q"]) == 0
    for number, model in enumerate((folder, tmp_path / "file" / "model.onnx")):
        out = tmp_path / str(number)
        capsys.readouterr()
        assert main(["predict", str(model), str(toy_set()), "--out", str(out), "--max-frames", "2"]) == 0
        line = "the net says of itself: doubtful here (95% below)"
        assert (line in capsys.readouterr().out) == told
        assert (line[1:] in (out / "index.html").read_text()) == told
