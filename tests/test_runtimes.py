"""The exported file in runtimes that nobody here wrote, and from another language."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from small_run import REAL_SETS, fresh_run, model_file, toy_frames

from horizon_dl.data.view import make_view
from horizon_dl.export.export import export_run, parity_frames
from horizon_dl.export.parity import TOLERANCE, obstacle_differences
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.readers.registry import open_recording

EXPORTS = Path(__file__).parent.parent / "exports"


@pytest.mark.real_data
@pytest.mark.parametrize("name", REAL_SETS)
def test_openvino_says_the_same_on_real_frames(data_dir, tmp_path, name):
    import openvino

    recording = open_recording(data_dir / name)
    frames = parity_frames(recording)[:3]
    run = fresh_run(frames)
    content = export_run(run, recording.camera, frames).content()
    path = tmp_path / "model.onnx"
    path.write_bytes(content)
    compiled = openvino.Core().compile_model(str(path), "CPU", {"INFERENCE_PRECISION_HINT": "f32"})
    for frame in frames:
        view = make_view(frame, run.config.image.max_pixels)
        wanted = EncodedImage(run.net, view.image).measures(view.elevation > 0)
        found = compiled({"image": frame.image[None], "up_cam": frame.up_cam.astype(np.float32)})
        assert np.abs(found["p_above"] - wanted.p_above).max() < TOLERANCE
        assert np.abs(found["mutual_information"] - wanted.mutual_information).max() < TOLERANCE
        differs, ties = obstacle_differences(found["obstacles"], wanted.entropy, run.threshold)
        assert not (differs & ~ties).any()


def test_openvino_says_the_same(model):
    import openvino

    core = openvino.Core()
    compiled = core.compile_model(str(model_file()), "CPU", {"INFERENCE_PRECISION_HINT": "f32"})
    for frame in toy_frames():
        wanted = model.predict(frame.image, frame.up_cam)
        feed = {"image": frame.image[None], "up_cam": frame.up_cam.astype(np.float32)}
        found = {key.get_any_name(): value for key, value in compiled(feed).items()}
        for name in ("p_above", "entropy", "mutual_information", "elevation"):
            np.testing.assert_allclose(found[name], getattr(wanted, name), atol=TOLERANCE, err_msg=name)
        ties = np.abs(wanted.entropy - model.threshold) < TOLERANCE
        if not ties.any():
            assert np.array_equal(found["obstacles"].astype(bool), wanted.obstacles)


@pytest.fixture(scope="module")
def node_folder(tmp_path_factory, no_network):
    """The Node.js example with its package, fetched without running any install script."""
    if not (shutil.which("node") and shutil.which("npm")):
        pytest.skip("Node.js is not installed")
    folder = tmp_path_factory.mktemp("node") / "example"
    shutil.copytree(EXPORTS / "node", folder, ignore=shutil.ignore_patterns("node_modules"))
    install = ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund"]
    done = subprocess.run(install, cwd=folder, capture_output=True, text=True, timeout=300)
    if done.returncode:
        no_network(f"the npm registry cannot be reached: {done.stderr}")
    return folder


@pytest.mark.slow
def test_node_says_the_same(model, node_folder):
    frame = toy_frames()[1]
    Image.fromarray(frame.image).save(node_folder / "picture.ppm")
    up_cam = [f"{part:.9g}" for part in frame.up_cam]
    command = ["node", "obstacles.mjs", str(model_file()), "picture.ppm", *up_cam, "--maps", "maps.json"]
    done = subprocess.run(command, cwd=node_folder, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    wanted = vars(model.predict(frame.image, frame.up_cam))
    for name, found in json.loads((node_folder / "maps.json").read_text()).items():
        np.testing.assert_allclose(np.reshape(found["data"], found["dims"]), wanted[name], atol=TOLERANCE)


@pytest.mark.slow
def test_node_refuses_a_damaged_file(node_folder):
    (node_folder / "cut.onnx").write_bytes(model_file().read_bytes()[:-1])
    command = ["node", "obstacles.mjs", "cut.onnx", "picture.ppm"]
    done = subprocess.run(command, cwd=node_folder, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert "is cut off" in done.stderr
