"""The runtime: what it refuses, and that it says what the run folder says."""

import json
import subprocess
import sys

import numpy as np
import onnx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from small_run import model_file, small_export, small_run, small_run_folder, toy_frames, toy_set
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.data.view import make_view
from horizon_dl.errors import InputError
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.runtime.checksum import BLANK, FORMAT, checksummed, read_checksummed
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.training.predict import predict
from horizon_dl.uncertainty.measures import measures

SAME = ("entropy", "surprisal", "fused")
"""Scores that file and run share to rounding; the mutual information is that of the net's coarse grid."""


def refusal(path) -> str:
    with pytest.raises(InputError) as error:
        ObstacleModel.load(path)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_the_model_knows_itself(model):
    run = small_run()
    assert (model.camera.width, model.camera.height) == (96, 72)
    assert model.threshold == run.threshold
    assert model.size == tuple(model.card["working_size"])
    assert len(model.sha256) == 64


def test_outputs_are_those_of_the_run(model):
    for frame in toy_frames():
        wanted = predict(small_run(), frame)
        found = model.predict(frame.image, frame.up_cam)
        np.testing.assert_allclose(found.p_above, wanted.measures.p_above, atol=1e-5)
        np.testing.assert_allclose(found.entropy, wanted.measures.entropy, atol=1e-4)
        np.testing.assert_allclose(found.elevation, wanted.view.elevation, atol=1e-6)
        assert found.entropy.dtype == np.float32
        assert found.obstacles.dtype == bool


def test_without_attitude_only_the_horizon_is_missing(model):
    frame = toy_frames()[0]
    known, unknown = model.predict(frame.image, frame.up_cam), model.predict(frame.image)
    assert np.isnan(unknown.elevation).all()
    assert not np.isnan(known.elevation).any()
    for name in ("p_above", "entropy", "expected_entropy", "mutual_information", "obstacles"):
        assert np.array_equal(getattr(known, name), getattr(unknown, name))


def test_it_repeats_itself(model):
    frame = toy_frames()[0]
    again = ObstacleModel.load(model_file(), threads=2)
    for name, value in vars(model.predict(frame.image, frame.up_cam)).items():
        np.testing.assert_allclose(getattr(again.predict(frame.image, frame.up_cam), name), value, atol=1e-6)


@pytest.mark.parametrize(
    ("image", "up_cam", "words"),
    [
        (np.zeros((72, 95, 3), np.uint8), None, "the model takes uint8"),
        (np.zeros((72, 96, 3), np.float32), None, "float32"),
        (np.zeros((72, 96, 3), np.uint8), [0, -2, 0], "no unit vector"),
        (np.zeros((72, 96, 3), np.uint8), [0, -1], "no unit vector"),
        (np.zeros((72, 96, 3), np.uint8), [np.nan, 0, 0], "no unit vector"),
    ],
)
def test_wrong_arguments_are_named(model, image, up_cam, words):
    with pytest.raises(ValueError, match=words):
        model.predict(image, up_cam)


def test_files_of_another_kind_are_refused(tmp_path):
    (tmp_path / "text.onnx").write_text("not a model")
    (tmp_path / "empty.onnx").write_bytes(b"")
    onnx.save(small_export().graph, tmp_path / "plain.onnx")
    for name in ("text", "empty", "plain"):
        assert "is no obstacle model" in refusal(tmp_path / f"{name}.onnx")
    assert "does not exist" in refusal(tmp_path / "nothing.onnx")
    assert "is a folder" in refusal(tmp_path)


@settings(max_examples=25, deadline=None)
@given(st.data())
def test_any_cut_and_any_altered_byte_is_noticed(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("damaged") / "model.onnx"
    content = bytearray(model_file().read_bytes())
    if data.draw(st.booleans(), label="cut"):
        content = content[: data.draw(st.integers(0, len(content) - 1))]
    else:
        content[data.draw(st.integers(0, len(content) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(content)
    with pytest.raises(InputError):
        read_checksummed(path)


def test_damage_is_told_apart(tmp_path):
    content = model_file().read_bytes()
    cut, longer, edited, newer = (tmp_path / f"{name}.onnx" for name in ("cut", "longer", "edited", "newer"))
    cut.write_bytes(content[:-1000])
    longer.write_bytes(content + b"\0")
    edited.write_bytes(content.replace(b'"samples": 12', b'"samples": 16'))
    newer.write_bytes(content.replace(f"format {FORMAT},".encode(), f"format {FORMAT + 2},".encode()))
    assert f"is cut off ({len(content) - 1000} of {len(content)} bytes)" in refusal(cut)
    assert "has grown" in refusal(longer)
    assert "was altered" in refusal(edited)
    assert "install the version" in refusal(newer)


def test_a_seal_does_not_make_a_model(tmp_path):
    fake = tmp_path / "fake.onnx"
    fake.write_bytes(checksummed(BLANK.encode() + b" and no graph"))
    assert "cannot be loaded" in refusal(fake)
    without_card = onnx.load_from_string(small_export().content())
    without_card.doc_string = BLANK
    del without_card.metadata_props[:]
    fake.write_bytes(checksummed(without_card.SerializeToString()))
    assert "cannot be loaded" in refusal(fake)
    with pytest.raises(ValueError, match="blank seal once"):
        checksummed(b"nothing")


def test_predict_gives_the_same_from_file_and_folder(tmp_path):
    for model, out in ((small_run_folder(), "run"), (model_file(), "file")):
        assert main(["predict", str(model), str(toy_set()), "--out", str(tmp_path / out)]) == 0
    assert len(list((tmp_path / "file" / "panels").iterdir())) == 24
    for path in (tmp_path / "run" / "arrays").iterdir():
        wanted, found = np.load(path), np.load(tmp_path / "file" / "arrays" / path.name)
        assert set(found) == set(wanted)
        for name in ("p_above", "entropy", "elevation_rad"):
            np.testing.assert_allclose(found[name], wanted[name], atol=1e-3)
        assert found["obstacles"].shape == wanted["obstacles"].shape
        assert (found["obstacles"] != wanted["obstacles"]).mean() < 1e-3


def test_evaluate_gives_the_same_from_file_and_folder(tmp_path):
    blocks = []
    for model, out in ((small_run_folder(), "run"), (model_file(), "file")):
        assert main(["evaluate", str(model), str(toy_set()), "--out", str(tmp_path / out)]) == 0
        blocks.append(json.loads((tmp_path / out / "metrics.json").read_text())["methods"]["cnn"])
    run, file = blocks
    for score in SAME:
        for figure in ("auc", "auc_within_depression", "ap"):
            assert file["scores"][score][figure] == pytest.approx(run["scores"][score][figure], abs=1e-3)
    assert file["operating_point"]["fpr"] == pytest.approx(run["operating_point"]["fpr"], abs=1e-3)
    assert file["horizon_accuracy"] == pytest.approx(run["horizon_accuracy"], abs=1e-3)


def test_plain_pictures_of_any_size_are_taken_with_a_note(tmp_path, capsys):
    folder = tmp_path / "pictures"
    folder.mkdir()
    whole = Image.fromarray(toy_frames()[0].image)
    whole.save(folder / "same.png")
    whole.resize((192, 144), Image.Resampling.NEAREST).save(folder / "twice.png")
    whole.resize((48, 36)).save(folder / "half.png")
    whole.crop((0, 0, 96, 40)).save(folder / "flat.png")
    assert main(["predict", str(model_file()), str(folder), "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out
    assert "note: images of another size than the model's 96x72 were scaled" in said
    assert "1 of 192x144" in said
    entropy = {path.stem: np.load(path)["entropy"] for path in (tmp_path / "out" / "arrays").iterdir()}
    shapes = {name: found.shape for name, found in entropy.items()}  # the model works at 81x61
    assert shapes == {"same": (61, 81), "twice": (61, 81), "half": (61, 81), "flat": (33, 81)}
    np.testing.assert_array_equal(entropy["twice"], entropy["same"])


def test_the_models_camera_at_another_size_has_the_same_rays(tmp_path, capsys):
    """Pixels repeated twice both ways: what is predicted, and where the horizon lies, is the same."""
    double = write_toy_set(tmp_path / "double", frames=2)
    camera = double / "camera.yaml"
    numbers = {"width: 96": "width: 192", "height: 72": "height: 144", "fx: 80.0": "fx: 160.0"}
    numbers |= {"fy: 80.0": "fy: 160.0", "cx: 47.5": "cx: 95.5", "cy: 35.5": "cy: 71.5"}
    text = camera.read_text()
    for old, new in numbers.items():
        assert old in text
        text = text.replace(old, new)
    single = write_toy_set(tmp_path / "single", frames=2)
    camera.write_text(text)
    for folder in ("images", "labels"):
        for path in (double / folder).iterdir():
            picture = Image.open(path)
            picture.resize((192, 144), Image.Resampling.NEAREST).save(path)
    for name in ("single", "double"):
        assert (
            main(["predict", str(model_file()), str(tmp_path / name), "--out", str(tmp_path / f"{name}-out")])
            == 0
        )
    assert "2 of 192x144" in capsys.readouterr().out
    assert single.exists()
    for path in (tmp_path / "single-out" / "arrays").iterdir():
        wanted, found = np.load(path), np.load(tmp_path / "double-out" / "arrays" / path.name)
        for name in ("entropy", "obstacles", "elevation_rad"):
            np.testing.assert_array_equal(found[name], wanted[name])


@pytest.mark.parametrize("verb", ["predict", "evaluate"])
def test_another_camera_is_refused_in_one_line(tmp_path, capfd, verb):
    other = write_toy_set(tmp_path / "other", frames=4)
    camera = other / "camera.yaml"
    camera.write_text(camera.read_text().replace("fx: 80.0", "fx: 70.0"))
    assert main([verb, str(model_file()), str(other), "--out", str(tmp_path / "out")]) == 2
    last = [line for line in capfd.readouterr().err.splitlines() if line.startswith("horizon-dl: ")]
    assert len(last) == 1
    assert "another camera" in last[0]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("verb", ["predict", "evaluate", "benchmark"])
def test_a_damaged_file_is_refused_in_one_line(tmp_path, capfd, verb):
    broken = tmp_path / "broken.onnx"
    broken.write_bytes(model_file().read_bytes()[:5000])
    rest = [] if verb == "benchmark" else [str(toy_set()), "--out", str(tmp_path / "out")]
    assert main([verb, str(broken), *rest]) == 2
    last = [line for line in capfd.readouterr().err.splitlines() if line.startswith("horizon-dl: ")]
    assert len(last) == 1
    assert "broken.onnx: is cut off" in last[0]


def test_the_runtime_imports_nothing_heavy():
    code = (
        "import sys\n"
        "import horizon_dl.runtime.predict, horizon_dl.runtime.benchmark, horizon_dl.data.source\n"
        "heavy = {'torch', 'kornia', 'sklearn', 'skimage', 'scipy', 'pydantic', 'matplotlib', 'onnx'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_summarised_measures_are_those_of_the_file(model):
    for frame in toy_frames():
        view = make_view(frame, small_run().config.image.max_pixels)
        wanted = EncodedImage(small_run().net, view.image).measures(view.elevation > 0)
        found = model.predict(frame.image, frame.up_cam)
        for name in ("p_above", "entropy", "expected_entropy", "mutual_information"):
            np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), atol=1e-4, err_msg=name)
        np.testing.assert_allclose(np.exp2(-found.surprisal), np.exp2(-wanted.surprisal), atol=1e-4)


def test_summarising_before_enlarging_changes_only_the_mutual_information():
    view = make_view(toy_frames()[0], small_run().config.image.max_pixels)
    above = view.elevation > 0
    early = EncodedImage(small_run().net, view.image).measures(above)
    late = measures(EncodedImage(small_run().net, view.image).samples(), above)
    for name in ("p_above", "entropy"):
        np.testing.assert_allclose(getattr(early, name), getattr(late, name), atol=1e-5, err_msg=name)
    assert np.abs(early.mutual_information - late.mutual_information).mean() < 0.02
