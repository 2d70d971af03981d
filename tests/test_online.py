"""The verb `online`: one pass, predict then learn."""

import json
import math
import os
import signal
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from tiny_online import assert_same_run, frame_lines, tiny_config, tiny_options, tiny_run
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.data.view import make_view
from horizon_dl.errors import InputError
from horizon_dl.evaluation.compare import compare
from horizon_dl.online.run import OnlineRun
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.training.online import learner as online_module
from horizon_dl.training.online.learner import OnlineLearner
from horizon_dl.training.run_folder import load_run


@pytest.fixture(scope="module")
def toy(tmp_path_factory) -> Path:
    return write_toy_set(tmp_path_factory.mktemp("toy") / "set", frames=30)


@pytest.fixture(scope="module")
def whole(toy, tmp_path_factory) -> Path:
    """An uninterrupted run."""
    out = tmp_path_factory.mktemp("whole") / "run"
    run = tiny_run(toy, out)
    run.run()
    run.finish()
    return out


def test_the_verb_writes_a_run_that_other_verbs_take(toy, tmp_path, capsys):
    out = tmp_path / "run"
    assert main(["online", str(toy), "--out", str(out), *tiny_options()]) == 0
    assert "learned from 30" in capsys.readouterr().out
    lines = frame_lines(out)
    assert [line["index"] for line in lines] == list(range(30))
    assert all(line["learned"] and line["loss"] > 0 for line in lines)
    assert lines[19]["auc"] is None
    assert 0 < lines[-1]["auc"] <= 1
    assert 0 < lines[-1]["calibration_error"] < 1
    assert 0.5 < lines[-1]["horizon_accuracy"] <= 1
    assert list((out / "logs").iterdir())
    info = json.loads((out / "run.json").read_text())
    assert 0 < info["threshold"] < 1
    assert info["online"]["not_learned"] == {}
    assert main(["evaluate", str(out), str(toy), "--out", str(tmp_path / "e")]) == 0
    assert main(["predict", str(out), str(toy), "--out", str(tmp_path / "p")]) == 0
    assert main(["export", str(out), "--out", str(tmp_path / "x")]) == 0


def test_the_figures_are_those_of_the_prequential_comparison(toy, whole):
    config = tiny_config("forest.training_pixels=2000", "forest.trees=2")
    wanted = compare(open_recording(toy), config, "prequential", [0]).metrics
    found = json.loads((whole / "metrics.json").read_text())
    assert found["methods"]["cnn"]["scores"] == wanted["methods"]["cnn"]["scores"]
    assert found["methods"]["cnn"].keys() == wanted["methods"]["cnn"].keys()
    accuracy = wanted["methods"]["cnn"]["horizon_accuracy"]
    assert found["methods"]["cnn"]["horizon_accuracy"] == pytest.approx(accuracy)
    assert found["frames"]["test"] == wanted["frames"]["test"] == 10
    assert found.keys() == wanted.keys()
    assert found["ranging"] == wanted["ranging"]


@pytest.mark.slow
def test_ranges_are_measured_and_survive_a_stop(tmp_path):
    ranging = {}
    for name, stops in (("whole", (40,)), ("stopped", (30, 40))):
        for stop in stops:
            run = tiny_run(embedded_set(), tmp_path / name, max_frames=stop)
            run.run()
            run.finish()
        ranging[name] = json.loads((tmp_path / name / "metrics.json").read_text())["ranging"]
    assert ranging["whole"]["columns"] > 20
    assert 0 < ranging["whole"]["median_relative_error"] < 1
    assert ranging["whole"]["true_floor"]["columns"] == ranging["whole"]["columns"]
    assert ranging["stopped"] == ranging["whole"]


@pytest.mark.parametrize("stops", [(1,), (7, 8, 20)])
def test_a_resumed_run_equals_an_uninterrupted_one(toy, whole, tmp_path, stops):
    for stop in (*stops, None):
        run = tiny_run(toy, tmp_path / "run", max_frames=stop)
        run.run()
        run.finish()
    assert run.position == 30
    assert_same_run(tmp_path / "run", whole)


def test_a_finished_run_stays_as_it_is(toy, whole, tmp_path):
    run = tiny_run(toy, tmp_path / "run")
    run.run()
    run.finish()
    again = tiny_run(toy, tmp_path / "run")
    again.run()
    again.finish()
    assert_same_run(tmp_path / "run", whole)


def test_sigterm_ends_in_order_and_the_next_start_goes_on(toy, whole, tmp_path, monkeypatch, capsys):
    out, real = tmp_path / "run", OnlineRun.settle

    def settle_then_signal(self, seen):
        real(self, seen)
        if seen.index == 9:
            os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(OnlineRun, "settle", settle_then_signal)
    before = signal.getsignal(signal.SIGTERM)
    assert main(["online", str(toy), "--out", str(out), *tiny_options()]) == 0
    assert "the same command goes on" in capsys.readouterr().out
    assert load_run(out).info["frames"] == 10
    assert signal.getsignal(signal.SIGTERM) == before
    monkeypatch.setattr(OnlineRun, "settle", real)
    assert main(["online", str(toy), "--out", str(out), *tiny_options()]) == 0
    assert "going on at frame 10" in capsys.readouterr().err
    assert_same_run(out, whole)


def test_restart_forgets_and_another_config_is_refused(toy, whole, tmp_path, capsys):
    out = tmp_path / "run"
    tiny_run(toy, out, "seed=5", max_frames=4).run()
    other = ["online", str(toy), "--out", str(out), *tiny_options()]
    assert main(other) == 2
    assert "another config" in capsys.readouterr().err
    assert main([*other, "--restart"]) == 0
    assert_same_run(out, whole)


def test_another_data_set_is_refused(toy, tmp_path):
    tiny_run(toy, tmp_path / "run", max_frames=2).run()
    other = write_toy_set(tmp_path / "other", frames=4)
    with pytest.raises(InputError, match=r"another data \(set\)"):
        tiny_run(other, tmp_path / "run")


def test_the_checkpoint_interval_may_change(toy, tmp_path):
    tiny_run(toy, tmp_path / "run", max_frames=4).run()
    assert tiny_run(toy, tmp_path / "run", "online.checkpoint_s=1").position == 3


def test_a_damaged_checkpoint_is_one_line(toy, tmp_path):
    tiny_run(toy, tmp_path / "run", max_frames=4).run()
    path = tmp_path / "run" / "checkpoint.safetensors"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InputError, match="damaged"):
        tiny_run(toy, tmp_path / "run")


def test_an_object_for_other_peoples_loops(toy):
    learner = OnlineLearner(tiny_config(), seed=0)
    frame = open_recording(toy).read(0)
    view = make_view(frame, 1728)
    by_frame, by_view = learner.predict(frame), learner.predict(view)
    assert np.array_equal(by_frame.p_above, by_view.p_above)
    assert by_frame.entropy.shape == view.elevation.shape
    assert math.isfinite(learner.learn(frame))
    assert not np.array_equal(learner.predict(frame).p_above, by_frame.p_above)


def test_a_frame_without_horizon_is_predicted_and_not_learned_from(toy):
    learner = OnlineLearner(tiny_config(), seed=0)
    frame = replace(open_recording(toy).read(0), up_cam=None)
    assert np.isfinite(learner.predict(frame).entropy).all()
    before = learner.predict(frame).p_above
    assert math.isnan(learner.learn(frame))
    assert np.array_equal(learner.predict(frame).p_above, before)
    assert (learner.frames, len(learner.memory)) == (0, 0)


@pytest.mark.parametrize("poison", ["loss", "gradient"])
def test_a_step_that_is_not_finite_leaves_everything_as_it_was(toy, monkeypatch, poison):
    recording = open_recording(toy)
    learner = OnlineLearner(tiny_config(), seed=0)
    learner.learn(recording.read(0))
    before = {
        name: tensor.clone()
        for name, tensor in learner.snapshot().tensors.items()
        if "net" in name or "average" in name or "optimiser" in name
    }
    real = online_module.horizon_loss

    def bad_loss(logits, batch):
        loss = real(logits, batch)
        if poison == "loss":
            return loss * float("nan")
        logits.register_hook(lambda gradient: gradient * float("inf"))
        return loss

    monkeypatch.setattr(online_module, "horizon_loss", bad_loss)
    assert math.isnan(learner.learn(recording.read(1)))
    assert learner.dropped == 2
    after = learner.snapshot().tensors
    assert all(torch.equal(tensor, after[name]) for name, tensor in before.items())
    monkeypatch.setattr(online_module, "horizon_loss", real)
    assert math.isfinite(learner.learn(recording.read(2)))


def test_a_set_without_truth_has_accuracy_but_no_auc(tmp_path):
    data = write_toy_set(tmp_path / "set", frames=24, labels=False)
    run = tiny_run(data, tmp_path / "run")
    run.run()
    run.finish()
    metrics = json.loads((tmp_path / "run" / "metrics.json").read_text())
    assert metrics["methods"]["cnn"]["scores"]["entropy"]["auc"] is None
    assert metrics["methods"]["cnn"]["horizon_accuracy"] > 0.5
    assert frame_lines(tmp_path / "run")[-1]["auc"] is None


def test_exports_appear_and_change_nothing_else(toy, whole, tmp_path):
    out = tmp_path / "run"
    run = tiny_run(toy, out, export_every_s=1e-3)
    hashes = set()
    stop = threading.Event()

    def watch() -> None:  # whatever is there at any time has to load
        while not stop.wait(0.02):
            if (out / "model.onnx").exists():
                hashes.add(ObstacleModel.load(out / "model.onnx").sha256)

    watcher = threading.Thread(target=watch)
    watcher.start()
    run.run()
    trained = run.finish()
    stop.set()
    watcher.join()
    assert len(hashes) >= 1
    assert run._export is not None
    assert run._export.written >= 2
    assert run._export.failed == 0
    model = ObstacleModel.load(out / "model.onnx")
    assert model.threshold == pytest.approx(trained.threshold)
    assert_same_run(out, whole)
