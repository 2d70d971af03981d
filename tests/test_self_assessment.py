"""What a net says of itself without labels."""

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml
from small_run import small_run, toy_set
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.data.view import make_view
from horizon_dl.evidence.self_assessment import OBSTACLE, SURE_BELOW, WORDS, SelfAssessment, said, verdict
from horizon_dl.inspection.data_check import check_recording
from horizon_dl.inspection.findings import with_findings
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.evidence import training_evidence
from horizon_dl.training.run_folder import save_run
from horizon_dl.uncertainty.measures import binary_entropy, p_of_entropy


def test_the_shares_are_those_of_the_pixels_below() -> None:
    rng = np.random.default_rng(0)
    assessment, below, sure, contradicted = SelfAssessment(), 0, 0, 0
    for _ in range(3):
        (p_above, p_obstacle), elevation = rng.random((2, 8, 9)), rng.uniform(-1, 1, (8, 9))
        elevation[0, 0] = np.nan
        assessment.update(p_above, p_obstacle, elevation)
        for p, other, angle in zip(p_above.ravel(), p_obstacle.ravel(), elevation.ravel(), strict=True):
            below += angle < 0
            sure += angle < 0 and p < SURE_BELOW
            contradicted += angle < 0 and p < SURE_BELOW and other > OBSTACLE
    found = assessment.compute()
    assert found["sure_below"] == pytest.approx(sure / below)
    assert found["contradicted"] == pytest.approx(contradicted / below)
    assert found["verdict"] == verdict(contradicted / below)


@pytest.mark.parametrize(
    ("share", "word"),
    [(0.08, "ok"), (0.19, "doubtful"), (0.39, "not to be trusted"), (None, "not to be trusted")],
)
def test_the_verdict_in_words(share: float | None, word: str) -> None:
    assert verdict(share) == word
    line = said({"contradicted": share, "verdict": word})
    assert (line is None) == (word == "ok")
    assert line is None or line.startswith(word)


def test_before_any_pixel_nothing_is_trusted() -> None:
    nothing = {"sure_below": None, "contradicted": None, "verdict": "not to be trusted"}
    assert SelfAssessment().compute() == nothing


@pytest.mark.parametrize(
    "damaged", [None, 3, "ok", [], {}, {"verdict": ["x"]}, {"verdict": "fine", "contradicted": 1}]
)
def test_what_is_no_assessment_says_nothing(damaged: object) -> None:
    assert said(damaged) is None


def test_the_teachers_level_reaches_the_place_that_is_flown_by(monkeypatch: pytest.MonkeyPatch) -> None:
    """A teacher that knows the net's own obstacles: the level lies where the net's floor ends."""
    run = small_run()
    recording = open_recording(toy_set())
    views = [make_view(recording.read(index), run.config.image.max_pixels) for index in range(0, 24, 4)]
    entropies = [binary_entropy(EncodedImage(run.net, view.image).p_above()) for view in views]
    level = float(np.median(np.concatenate([one.ravel() for one in entropies])))

    class Teacher(EncodedImage):
        def of_all_depths(self, size=None):
            known = binary_entropy(EncodedImage(run.net, self.shown).p_above())
            return np.where(known > level, np.float32(0.99), np.float32(0.01))

        def __init__(self, net, image):
            super().__init__(run.net, image)
            self.shown = image

    monkeypatch.setattr(
        "horizon_dl.training.evidence.EncodedImage",
        lambda net, image: (EncodedImage if net is run.net else Teacher)(net, image),
    )
    found = training_evidence(run.net, views, run.config)
    assert found["simulated_threshold"] == pytest.approx(level, abs=0.01)
    assert found["evidence"]["obstacle_p"] == pytest.approx(p_of_entropy(found["simulated_threshold"]))


def test_a_damaged_share_costs_the_number_alone() -> None:
    assert said({"verdict": "doubtful", "contradicted": "much"}) == said({"verdict": "doubtful"})


@pytest.mark.parametrize(("share", "told"), [(0.05, False), (0.2, True)])
def test_who_looks_at_predictions_reads_it_too(share, told, tmp_path, capsys) -> None:
    """On the page and in the terminal, of a run and of the file exported from it."""
    run, folder = small_run(), tmp_path / "run"
    folder.mkdir()
    assessment = {"contradicted": share, "verdict": verdict(share)}
    save_run(folder, replace(run, info={**run.info, "self_assessment": assessment}))
    assert main(["export", str(folder), "--out", str(tmp_path / "file"), "-q"]) == 0
    for number, model in enumerate((folder, tmp_path / "file" / "model.onnx")):
        out = tmp_path / str(number)
        capsys.readouterr()
        assert main(["predict", str(model), str(toy_set()), "--out", str(out), "--max-frames", "2"]) == 0
        line = "the net says of itself: doubtful here: it is sure that 20% of the ground"
        assert (line in capsys.readouterr().out) == told
        assert (line[1:] in (out / "index.html").read_text()) == told


def test_check_data_trains_a_quick_net_where_asked(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("horizon_dl.training.quick.ROUNDS", (2, 2))
    monkeypatch.setattr("horizon_dl.training.quick.FRAMES", 5)
    data = write_toy_set(tmp_path / "set", frames=30)
    assert main(["check-data", str(data), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["self_assessment"] is None
    assert main(["check-data", str(data), "--json", "--quick-train", "--out", str(tmp_path / "out")]) == 0
    printed = json.loads(capsys.readouterr().out)
    found = printed["self_assessment"]
    assert found["verdict"] in WORDS
    assert 0.0 <= found["contradicted"] <= found["sure_below"] <= 1.0
    assert json.loads((tmp_path / "out" / "check.json").read_text())["self_assessment"] == found
    assert "quickly trained net says of itself" in (tmp_path / "out" / "index.html").read_text()


@pytest.mark.parametrize(("share", "level"), [(0.05, "ok"), (0.2, "warning"), (0.4, "warning")])
def test_what_a_quick_net_says_is_a_finding(share, level):
    check = check_recording(open_recording(toy_set()), band_rad=0.02, max_pixels=4800)
    heard = with_findings(replace(check, self_assessment={"contradicted": share, "verdict": verdict(share)}))
    (finding,) = set(heard.findings) - set(check.findings)
    assert finding.level == level
    assert ("not to be trusted" in heard.verdict) == (share > 0.24)


def test_what_cannot_work_is_not_trained_on(tmp_path, monkeypatch, capsys):
    def fail(*_, **__):
        raise AssertionError("trained")

    monkeypatch.setattr("horizon_dl.training.quick.train_run", fail)
    data = write_toy_set(tmp_path / "set", frames=30)
    camera = yaml.safe_load((data / "camera.yaml").read_text())
    (data / "camera.yaml").write_text(yaml.safe_dump(camera | {"mount_rpy_deg": [0, -80, 0]}))
    assert main(["check-data", str(data), "--json", "--quick-train"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["level"] == "problem"
    assert found["self_assessment"] is None
