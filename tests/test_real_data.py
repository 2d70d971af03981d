"""The whole comparison on the real sets, from the command line, two of them with the default config."""

import json

import pytest

from horizon_dl.cli import main

# Pooled AUC of the forest's entropy, with room for one seed and another machine: one made weak would be a
# cheap win, one that is too good a sign of a leak.
FOREST_AUC = {
    "arena": (0.85, 0.93),
    "corridor": (0.69, 0.80),
    "hallway": (0.73, 0.81),
    "kitti": (0.64, 0.74),
}
MARGIN = 0.03  # of one seed on any machine; the means of three seeds are 0.05 and more apart

pytestmark = [pytest.mark.slow, pytest.mark.long, pytest.mark.real_data]


def scores(folder) -> dict:
    methods = json.loads((folder / "metrics.json").read_text())["methods"]
    return {name: block["scores"] for name, block in methods.items()}


@pytest.mark.parametrize("name", list(FOREST_AUC))
def test_the_net_beats_the_forest(data_dir, tmp_path, name):
    arguments = ["compare", str(data_dir / name), "--out", str(tmp_path / "out"), "--seeds", "1"]
    # Where the margin is wide half of the steps will do.
    half = ["--train.rounds", "[100, 150]"] if name in ("arena", "corridor") else []
    assert main([*arguments, *half]) == 0
    found = scores(tmp_path / "out")
    net, forest = found["cnn"]["entropy"], found["rf"]["entropy"]
    low, high = FOREST_AUC[name]
    assert low < forest["auc"] < high
    for figure in ("auc", "auc_within_depression"):
        assert net[figure] > forest[figure] + MARGIN
        # Above whatever needs no learning, too, within the bands; pooled, the fused score is.
    within = "auc_within_depression"
    assert net[within] > max(found[free]["score"][within] for free in ("position", "diffusion", "geodesic"))
    assert found["cnn"]["fused"]["auc"] > found["position"]["score"]["auc"] + MARGIN / 2


def test_the_papers_protocol_on_kitti(data_dir, tmp_path):
    arguments = ["compare", str(data_dir / "kitti"), "--out", str(tmp_path / "out"), "--seeds", "1"]
    assert main([*arguments, "--protocol", "tail", "--train.rounds", "[60, 40]"]) == 0
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert metrics["frames"]["train"] == 54
    for name in ("cnn", "rf"):
        point = metrics["methods"][name]["operating_point"]
        assert 0 < point["threshold"] < 1
        assert point["fpr"] < point["tpr"]
        assert point["fpr_filtered"] <= point["fpr"]


def test_labels_of_unlabelled_frames_are_not_needed(data_dir, tmp_path):
    """EuRoC has no truth and no attitude but the IMU's."""
    arguments = ["compare", str(data_dir / "euroc_sample"), "--out", str(tmp_path / "out"), "--seeds", "1"]
    assert main([*arguments, "--train.rounds", "[20, 10]", "--forest.training_pixels", "20000"]) == 0
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert metrics["methods"]["cnn"]["horizon_accuracy"] > 0.5
    assert metrics["methods"]["cnn"]["scores"]["entropy"]["auc"] is None
