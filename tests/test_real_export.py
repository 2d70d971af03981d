"""Run folder and model file on the real sets: the same figures."""

import json

import pytest

from horizon_dl.cli import main

pytestmark = [pytest.mark.slow, pytest.mark.long, pytest.mark.real_data]


@pytest.mark.parametrize("name", ["arena", "hallway"])  # the others have many more labelled frames
def test_the_file_earns_what_the_run_earns(data_dir, tmp_path, name):
    data, run, model = str(data_dir / name), str(tmp_path / "run"), tmp_path / "model"
    small = ["--image.max_pixels", "20000", "--train.rounds", "[15, 10]"]  # a quarter of the time
    assert main(["train", data, "--out", run, *small]) == 0
    assert main(["export", run, "--out", str(model), "--data", data]) == 0
    found = []
    for learner in (run, str(model / "model.onnx")):
        assert main(["evaluate", learner, data, "--out", str(tmp_path / "eval"), "--overwrite"]) == 0
        found.append(json.loads((tmp_path / "eval" / "metrics.json").read_text())["methods"]["cnn"])
    of_run, of_file = found
    for score, figures in of_file["scores"].items():
        for key in ("auc", "auc_within_depression", "ap"):
            assert figures[key] == pytest.approx(of_run["scores"][score][key], abs=1e-3)
    for key in ("tpr", "fpr"):
        assert of_file["operating_point"][key] == pytest.approx(of_run["operating_point"][key], abs=1e-3)
