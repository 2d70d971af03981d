"""The forest as a model file, against scikit-image, scikit-learn and skl2onnx."""

import json

import numpy as np
import onnxruntime
import pytest
import torch
from PIL import Image
from sklearn.ensemble import RandomForestClassifier
from small_run import REAL_SETS, SETTINGS, small_run_folder, toy_frames, toy_set

from horizon_dl.cli import main
from horizon_dl.config import Config
from horizon_dl.data.view import make_view
from horizon_dl.export.card import make_forest_card
from horizon_dl.export.export import exported, parity_frames
from horizon_dl.export.forest import cost_line, export_forest
from horizon_dl.export.forest_features import ForestFeatures
from horizon_dl.export.forest_trees import TreeVotes, float32_below
from horizon_dl.models.features import pixel_features
from horizon_dl.models.forest import HorizonForest
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.uncertainty.measures import measures


def pictures():
    rng = np.random.default_rng(0)
    noise = rng.integers(0, 256, (41, 53, 3), dtype=np.uint8)
    coarse = Image.fromarray(rng.integers(0, 256, (5, 6, 3), dtype=np.uint8))
    smooth = np.array(coarse.resize((64, 48), Image.Resampling.BICUBIC))
    few = (rng.integers(0, 3, (30, 40, 3)) * 127).astype(np.uint8)
    return {"noise": noise, "smooth": smooth, "few levels": few, "flat": np.full((20, 24, 3), 77, np.uint8)}


@pytest.mark.parametrize("interleaved", [True, False])
@pytest.mark.parametrize("kind", pictures())
def test_features_are_scikit_images_to_the_bit(kind, interleaved):
    picture = pictures()[kind]
    height, width = picture.shape[:2]
    image = torch.tensor(picture)[None]
    if not interleaved:
        image = image.permute(0, 3, 1, 2).float()
    found = ForestFeatures((width, height), interleaved=interleaved)(image)
    assert np.array_equal(found.numpy(), pixel_features(picture).reshape(-1, 13))


@pytest.mark.real_data
@pytest.mark.parametrize("name", REAL_SETS)
def test_features_are_scikit_images_on_real_frames(data_dir, name):
    for frame in parity_frames(open_recording(data_dir / name))[:2]:
        image = make_view(frame, 76_800).image
        height, width = image.shape[:2]
        found = ForestFeatures((width, height), interleaved=True)(torch.tensor(image)[None])
        assert np.array_equal(found.numpy(), pixel_features(image).reshape(-1, 13))


@pytest.fixture(scope="module")
def forest_export():
    return export_forest(open_recording(toy_set()), Config.model_validate(SETTINGS))


def test_the_file_says_what_the_forest_says_at_every_optimisation_level(forest_export):
    figures = forest_export.card["parity"]
    assert figures["on"] == "real frames"
    assert len(figures["levels"]) == 5
    for level in figures["levels"].values():
        assert max(level[name] for name in ("p_above", "entropy", "mutual_information")) < 1e-5
        assert level["beyond_ties"] == 0


def test_a_tree_of_one_leaf_is_exported_too():
    rng = np.random.default_rng(0)
    features = rng.random((600, 13), np.float32)
    labels = (features[:, 2] + 0.3 * rng.random(600) > 0.6).astype(int)
    classifier = RandomForestClassifier(3, random_state=0, min_samples_leaf=2).fit(features, labels)
    leaf = RandomForestClassifier(1, min_samples_leaf=400, random_state=0).fit(features, labels)
    assert leaf.estimators_[0].tree_.node_count == 1
    classifier.estimators_.append(leaf.estimators_[0])
    forest = HorizonForest(classifier, 1)
    card = make_forest_card(forest, open_recording(toy_set()), Config(), 0.5, 0.0, None)
    assert exported(forest, 5000, 0.5, card).card["parity"]["good"]


def test_thresholds_are_rounded_down():
    values = np.array([0.1, 0.5, -0.1, 1 / 3])
    below = float32_below(values)
    assert below.dtype == np.float32
    assert (below.astype(float) <= values).all()
    assert (np.nextafter(below, np.float32(np.inf)).astype(float) > values).all()


def test_votes_against_another_converter(forest_export):
    """skl2onnx knows nothing of this program's operators; its file gives the mean vote of the same forest."""
    import skl2onnx

    views = [make_view(frame, 5000) for frame in toy_frames()]
    forest = HorizonForest.fit(views, seed=0, training_pixels=3000, n_jobs=1)
    kind = skl2onnx.common.data_types.FloatTensorType([None, 13])
    other = skl2onnx.to_onnx(
        forest.classifier,
        initial_types=[("x", kind)],
        options={"zipmap": False},
        target_opset={"": 18, "ai.onnx.ml": 3},
    )
    session = onnxruntime.InferenceSession(other.SerializeToString(), providers=["CPUExecutionProvider"])
    features = pixel_features(views[0].image).reshape(-1, 13)
    wanted = session.run(None, {"x": features})[1][:, 1]
    height, width = views[0].image.shape[:2]
    mean, information = TreeVotes(forest, (width, height))(torch.tensor(features))
    np.testing.assert_allclose(mean.numpy().ravel(), wanted, atol=1e-5)
    truth = measures(forest.p_above_samples(views[0]), views[0].elevation > 0)
    np.testing.assert_allclose(information, truth.mutual_information, atol=1e-5)


def test_the_card_says_that_it_is_the_forest(forest_export, tmp_path):
    model = ObstacleModel.load(forest_export.write(tmp_path, "forest"))
    assert model.card["learner"] == "rf"
    assert model.card["forest"]["trees"] == 20
    assert model.card["forest"]["nodes"] > 20
    assert len(model.card["weights_sha256"]) == 64
    assert 0 < model.threshold < 1
    assert (tmp_path / "forest.card.json").is_file()


def test_the_command_exports_it_and_the_other_verbs_take_it(tmp_path, capsys):
    out, data = tmp_path / "out", str(toy_set())
    arguments = ["export", str(small_run_folder()), "--out", str(out), "--data", data, "--forest", data]
    assert main(arguments) == 0
    assert "times as long as the net" in capsys.readouterr().out
    card = json.loads((out / "forest.card.json").read_text())
    assert card["cost"]["times_as_long"] == pytest.approx(card["cost"]["forest_ms"] / card["cost"]["net_ms"])
    assert card["cost"]["forest_bytes"] > card["cost"]["net_bytes"] / 10
    assert 0.5 < card["measured"]["auc"] <= 1
    file = str(out / "forest.onnx")
    assert main(["predict", file, data, "--out", str(tmp_path / "pred")]) == 0
    assert main(["evaluate", file, data, "--out", str(tmp_path / "eval")]) == 0
    methods = json.loads((tmp_path / "eval" / "metrics.json").read_text())["methods"]
    assert methods["rf"]["scores"]["entropy"]["auc"] == pytest.approx(card["measured"]["auc"], abs=1e-6)
    assert "cnn" not in methods
    assert (
        main(["benchmark", file, "--runs", "2", "--threads", "1", "--out", str(tmp_path / "times.json")]) == 0
    )
    times = json.loads((tmp_path / "times.json").read_text())["models"][0]["threads"]["1"]["stages_ms"]
    assert times["uncertainty"] > times["obstacles"]


def test_the_cost_in_words():
    cost = {"forest_ms": 160.0, "times_as_long": 32.0, "forest_bytes": 9_100_000, "net_bytes": 260_000}
    words = "forest: 160 ms a frame at one thread, 32 times as long as the net; 9.1 MB, the net 0.3 MB"
    assert cost_line(cost) == words
