"""The exported graph against the library, float64 formulas, and a second runtime."""

import hashlib
import json
from dataclasses import asdict
from types import MethodType

import numpy as np
import onnx
import pytest
import torch
from PIL import Image
from scipy import ndimage
from small_run import (
    REAL_SETS,
    SETTINGS,
    fresh_run,
    small_export,
    small_run,
    small_run_folder,
    toy_frames,
    toy_set,
)
from torch.nn import functional as F  # noqa: N812

from horizon_dl.cli import main
from horizon_dl.data.view import make_view
from horizon_dl.export.card import INPUTS, OUTPUTS
from horizon_dl.export.export import export_run, parity_frames, trained_camera
from horizon_dl.export.graph import Pipeline, bilinear_weights, summaries
from horizon_dl.export.int8 import verdict
from horizon_dl.export.onnx_file import RANDOM_OPERATORS, graph_of
from horizon_dl.export.parity import LEVELS, TOLERANCE, sample_frames
from horizon_dl.export.resize import AreaShrink, NearestEnlarge
from horizon_dl.export.smoke_test import export_and_try
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import area_resize
from horizon_dl.models.build import build_net
from horizon_dl.models.encoded import EncodedImage, image_tensor
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.uncertainty.measures import binary_entropy


@pytest.mark.parametrize("level", LEVELS)
def test_the_file_says_what_the_run_says_at_every_optimisation_level(level):
    found = small_export().card["parity"]["levels"][level]
    for name in ("p_above", "entropy", "surprisal", "elevation"):
        assert found[name] < TOLERANCE
    assert found["beyond_ties"] == 0


@pytest.mark.real_data
@pytest.mark.parametrize("name", REAL_SETS)
def test_parity_on_real_frames(data_dir, name):
    recording = open_recording(data_dir / name)
    frames = parity_frames(recording)[:4]
    figures = export_run(fresh_run(frames), recording.camera, frames).card["parity"]
    assert figures["frames"] == len(frames)
    worst = max(one[key] for one in figures["levels"].values() for key in ("p_above", "entropy"))
    assert worst < TOLERANCE


def test_dropout_is_in_the_file(model):
    """The trap: a runtime that drops the dropout gives the single pass, which looks right."""
    for frame in toy_frames():
        view = make_view(frame, small_run().config.image.max_pixels)
        sampled = binary_entropy(EncodedImage(small_run().net, view.image).samples().mean(axis=0))
        single = binary_entropy(EncodedImage(small_run().net, view.image).single_pass()[0])
        exported = model.predict(frame.image, frame.up_cam).entropy
        assert np.abs(exported - sampled).max() < TOLERANCE
        assert np.abs(exported - single).max() > 20 * TOLERANCE


def test_no_operator_is_random():
    operators = {node.op_type for node in small_export().graph.graph.node}
    assert not operators & RANDOM_OPERATORS
    assert all(not node.domain for node in small_export().graph.graph.node)


def test_a_graph_with_a_dropout_operator_is_refused():
    net = build_net(small_run().config.model)

    def naive(self, features):
        return HorizonFCN.sample_logits(self, F.dropout(features, 0.3, training=True))

    net.sample_logits = MethodType(naive, net)
    module = Pipeline(net.eval(), Camera("pinhole", 64, 48, 50.0, 50.0, 31.5, 23.5), 5000, 0.5)
    with pytest.raises(RuntimeError, match="may not be random"):
        graph_of(module)


def test_summaries_against_the_formula_in_float64():
    logits = torch.randn(12, 500, generator=torch.Generator().manual_seed(0)) * 8
    mean, expected = summaries(logits)
    p = 1 / (1 + np.exp(-logits.double().numpy()))
    entropy = -p * np.log2(p) - (1 - p) * np.log2(1 - p)
    np.testing.assert_allclose(mean, p.mean(axis=0), atol=1e-6)
    np.testing.assert_allclose(expected, entropy.mean(axis=0), atol=1e-5)


@pytest.mark.parametrize("samples", [1, 2, 3, 5, 6, 16])
def test_summaries_of_any_number_of_samples_even_when_sure(samples):
    logits = torch.linspace(-200, 200, 41).repeat(samples, 1)
    mean, expected = summaries(logits)
    np.testing.assert_allclose(mean, logits[0].sigmoid(), atol=1e-6)
    np.testing.assert_allclose(expected, binary_entropy(logits[0].sigmoid()), atol=1e-4)


def test_mutual_information_is_that_of_the_coarse_grid(model):
    frame, net = toy_frames()[0], small_run().net
    view = make_view(frame, small_run().config.image.max_pixels)
    with torch.no_grad():
        p = net.sample_logits(net.encode(image_tensor(view.image)))[0].double().sigmoid().numpy()
    coarse = _bits(p.mean(axis=0)) - _bits(p).mean(axis=0)
    wanted = F.interpolate(torch.tensor(coarse)[None, None], size=view.image.shape[:2], mode="bilinear")[0, 0]
    found = model.predict(frame.image, frame.up_cam)
    np.testing.assert_allclose(found.mutual_information, wanted, atol=1e-5)
    np.testing.assert_allclose(
        found.expected_entropy, (found.entropy - found.mutual_information).clip(0), atol=1e-6
    )


def _bits(p):
    return -p * np.log2(p) - (1 - p) * np.log2(1 - p)


def test_obstacles_against_a_convolution(model):
    frame = toy_frames()[1]
    found = model.predict(frame.image, frame.up_cam)
    over = found.entropy > model.threshold
    neighbours = ndimage.convolve(over.astype(int), np.ones((3, 3), int), mode="constant") - over
    wanted = torch.tensor((over & (neighbours >= 1)).astype(np.float32))[None, None]
    enlarged = F.interpolate(wanted, size=frame.image.shape[:2], mode="nearest-exact")[0, 0].numpy()
    assert found.obstacles.shape == frame.image.shape[:2]
    assert np.array_equal(found.obstacles, enlarged.astype(bool))
    assert 0 < found.obstacles.mean() < 1


@pytest.mark.parametrize(
    ("image", "size"),
    [((97, 71), (31, 70)), ((64, 48), (32, 24)), ((600, 90), (290, 44))],
)
def test_the_graph_resizes_as_the_library_to_the_bit(image, size):
    picture = np.random.default_rng(0).integers(0, 256, (image[1], image[0], 3), dtype=np.uint8)
    shrunk = AreaShrink(image, size)(torch.tensor(picture)[None])[0].permute(1, 2, 0).numpy()
    assert np.array_equal(shrunk, area_resize(picture, size))


def test_enlarging_weights_are_those_of_the_net():
    maps = torch.rand(1, 1, 13, 17, generator=torch.Generator().manual_seed(0))
    product = bilinear_weights(13, 50) @ maps @ bilinear_weights(17, 66).T
    wanted = F.interpolate(maps, size=(50, 66), mode="bilinear", align_corners=False)
    torch.testing.assert_close(product, wanted)


@pytest.mark.parametrize(
    ("size", "image"), [((503, 151), (1242, 375)), ((320, 240), (640, 480)), ((31, 70), (97, 71))]
)
def test_nearest_enlarging_is_pillows(size, image):
    mask = np.random.default_rng(0).integers(0, 2, size[::-1], dtype=np.uint8)
    wanted = np.asarray(Image.fromarray(mask).resize(image, Image.Resampling.NEAREST))
    assert np.array_equal(NearestEnlarge(size, image)(torch.tensor(mask)), wanted)


def test_inputs_and_outputs_are_named_and_described():
    file = onnx.load_from_string(small_export().content())
    onnx.checker.check_model(file, full_check=True)
    assert [value.name for value in file.graph.input] == list(INPUTS)
    assert [value.name for value in file.graph.output] == list(OUTPUTS)
    for value in (*file.graph.input, *file.graph.output):
        assert value.doc_string == {**INPUTS, **OUTPUTS}[value.name]
    assert file.opset_import[0].version >= 17


def test_the_card_is_in_the_file_and_complete():
    run, card = small_run(), small_export().card
    file = onnx.load_from_string(small_export().content())
    properties = {one.key: one.value for one in file.metadata_props}
    assert json.loads(properties["card"]) == json.loads(json.dumps(card))
    weights = (small_run_folder() / "weights.safetensors").read_bytes()
    assert card["weights_sha256"] == hashlib.sha256(weights).hexdigest()
    assert card["threshold"]["value"] == run.threshold
    assert card["threshold"]["rule"] == "percentile-75"
    assert (card["net"]["dropout"], card["net"]["samples"]) == (run.config.model.dropout, 12)
    assert card["camera"] == asdict(trained_camera(run, "run"))
    assert (card["image_size"], card["trained_camera"]) == ([96, 72], True)
    assert card["working_size"][0] * card["working_size"][1] <= SETTINGS["image"]["max_pixels"]
    assert card["trained_on"]["data"] == "set"
    assert {"licence", "patents", "limits", "versions", "left_out", "inputs", "outputs"} <= set(card)


def test_the_same_run_gives_the_same_bytes():
    assert small_export().content() == small_export().content()
    again = graph_of(
        Pipeline(small_run().net, trained_camera(small_run(), "run"), 5000, small_run().threshold)
    )
    assert again.SerializeToString(deterministic=True) == small_export().graph.SerializeToString(
        deterministic=True
    )


def test_nothing_of_this_machine_is_in_the_file():
    content = small_export().content()
    for word in (b"site-packages", b"/home", b"/root", b"/tmp", b"horizon_dl/", b".py"):
        assert word not in content


def test_other_lenses_have_their_rays_in_the_file():
    camera = Camera("radtan", 80, 60, 48.0, 48.0, 39.5, 29.5, (-0.35, 0.12, 0.0, 0.0, 0.0))
    fisheye = Camera("kannala_brandt", 80, 60, 20.0, 20.0, 39.5, 29.5, (0.01, 0.0, 0.0, 0.0))
    for one in (camera, fisheye):
        figures = export_run(small_run(), one).card["parity"]
        assert max(level["elevation"] for level in figures["levels"].values()) < 1e-5


def test_made_up_frames_stand_in_for_missing_data():
    camera = trained_camera(small_run(), "run")
    frames = sample_frames(camera)
    assert all(abs(np.linalg.norm(frame.up_cam) - 1) < 1e-9 for frame in frames)
    assert export_run(small_run(), camera).card["parity"]["on"] == "made-up frames"


def test_the_command_writes_file_card_parity_and_sizes(tmp_path, capsys):
    out, data = tmp_path / "out", str(toy_set())
    run = str(small_run_folder())
    assert main(["export", run, "--out", str(out), "--data", data, "--size", "48x36"]) == 0
    assert {path.name for path in out.iterdir()} >= {
        "model.onnx",
        "card.json",
        "parity.json",
        "model-48x36.onnx",
    }
    card = json.loads((out / "card.json").read_text())
    assert card["false_positive_rate"] == card["measured"]["fpr"]
    assert 0 < card["measured"]["auc"] < 1
    assert card["parity"]["good"]
    assert ObstacleModel.load(out / "model.onnx").card == card
    assert ObstacleModel.load(out / "model-48x36.onnx").camera.width == 48
    assert "AUC" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "does not exist"),
        (["RUN", "--size", "90x90"], "another aspect"),
        (["RUN", "--int8"], "--data"),
        (["RUN", "--data", "nowhere"], "does not exist"),
    ],
)
def test_bad_input_is_one_line(tmp_path, capsys, arguments, words):
    places = {"RUN": str(small_run_folder())}
    full = [places.get(argument, argument) for argument in arguments]
    assert main(["export", *full, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_int8_states_its_gain_and_its_cost(tmp_path, capsys):
    arguments = [str(small_run_folder()), "--out", str(tmp_path / "out"), "--data", str(toy_set()), "--int8"]
    assert main(["export", *arguments]) == 0
    card = ObstacleModel.load(tmp_path / "out" / "model-int8.onnx").card
    assert card["int8"]["speed_up"] == pytest.approx(card["int8"]["float32_ms"] / card["int8"]["int8_ms"])
    assert abs(card["int8"]["auc_change"]) < 0.1
    operators = {node.op_type for node in onnx.load(tmp_path / "out" / "model-int8.onnx").graph.node}
    assert "QuantizeLinear" in operators
    assert "times as fast; AUC" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("speed_up", "auc_change", "words"),
    [(0.6, 0.0, "it is slower"), (1.5, -0.02, "it costs AUC"), (0.6, -0.02, "it is slower and it costs AUC")],
)
def test_int8_advises_against_itself_where_it_loses(speed_up, auc_change, words):
    figures = {"float32_ms": 3.0, "int8_ms": 3.0 / speed_up, "speed_up": speed_up, "auc_change": auc_change}
    assert words in verdict(figures)[-1]
    assert "not advised" in verdict(figures)[-1]
    assert len(verdict({**figures, "speed_up": 1.4, "auc_change": 0.001})) == 1


def test_export_and_try(tmp_path):
    tried = export_and_try(small_run(), open_recording(toy_set()), tmp_path)
    assert tried.path == tmp_path / "model.onnx"
    assert tried.difference < TOLERANCE
    frame = toy_frames()[0]
    assert 0 < ObstacleModel.load(tried.path).predict(frame.image, frame.up_cam).obstacles.mean() < 1
    assert tried.median_ms > 0
    assert "MB" in tried.lines()[0]
    assert "ms a frame" in tried.lines()[1]
