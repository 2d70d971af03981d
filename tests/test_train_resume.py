"""Training that is stopped or killed goes on to the same weights."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from safetensors.torch import load_file
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.config import load_config
from horizon_dl.errors import InputError
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.resumable import CHECKPOINT, TrainingKeeper, TrainingStopped
from horizon_dl.training.train import train_run

QUICK = {
    "train.rounds": "[6, 5, 4]",
    "train.batch": "3",
    "train.crop": "32",
    "train.memory_mb": "1",
    "model.channels": "6",
    "model.samples": "4",
}
OPTIONS = [word for key, value in QUICK.items() for word in (f"--{key}", value)]


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """With more frames than the pool holds."""
    return open_recording(write_toy_set(tmp_path_factory.mktemp("toy") / "set", frames=40))


@pytest.fixture(scope="module")
def config():
    return load_config(None, [f"{key}={value}" for key, value in QUICK.items()])


@pytest.fixture(scope="module")
def whole(recording, config):
    return train_run(recording, config)


class Stopping(TrainingKeeper):
    """Is told to stop when it has been asked a number of times whether a checkpoint is due."""

    def __init__(self, *arguments, after: int, **options) -> None:
        super().__init__(*arguments, **options)
        self.left = after

    def due(self) -> bool:
        self.left -= 1
        self.stopped = self.stopped or self.left == 0
        return super().due()


def assert_equal(run, whole) -> None:
    ours, theirs = run.net.state_dict(), whole.net.state_dict()
    assert all(tensor.equal(theirs[name]) for name, tensor in ours.items())
    assert run.threshold == whole.threshold
    assert run.info["frames"] == whole.info["frames"]


@pytest.mark.parametrize("stops", [(1,), (8,), (2, 3, 3)])
def test_stopped_at_any_step_training_ends_with_the_same_weights(recording, config, whole, tmp_path, stops):
    for number, after in enumerate(stops):
        keeper = Stopping(tmp_path, recording, config, resume=number > 0, after=after)
        with pytest.raises(TrainingStopped, match="--resume goes on"):
            train_run(recording, config, keeper=keeper)
        assert (tmp_path / CHECKPOINT).is_file()
    assert_equal(
        train_run(recording, config, keeper=TrainingKeeper(tmp_path, recording, config, resume=True)), whole
    )


@pytest.mark.parametrize(("agreement", "channels"), [("-1", "6"), ("2", "6"), ("2", "32")])
def test_stopped_in_the_last_round_context_heads_and_teacher_are_decided_as_before(
    recording, tmp_path, agreement, channels, monkeypatch
):
    monkeypatch.setattr("horizon_dl.training.context.LEAST_STEPS", 0)
    monkeypatch.setattr("horizon_dl.training.context.agreement_of", lambda *_: 0.5)
    settings = {
        **QUICK,
        "model.channels": channels,
        "train.context_agreement": agreement,
        "train.context_crop": "40",
        "train.context_batch": "2",
    }
    config = load_config(None, [f"{key}={value}" for key, value in settings.items()])
    keeper = Stopping(tmp_path, recording, config, after=11)
    with pytest.raises(TrainingStopped):
        train_run(recording, config, keeper=keeper)
    again = TrainingKeeper(tmp_path, recording, config, resume=True)
    assert again.found.number == 2
    assert again.found.step > 0
    run, whole = train_run(recording, config, keeper=again), train_run(recording, config)
    assert_equal(run, whole)
    assert run.info["path_agreement"] == whole.info["path_agreement"]
    assert run.net.deep_share == pytest.approx(1.0 if agreement == "-1" else 0.05 / 0.35)


def test_a_checkpoint_of_another_training_is_one_line(recording, config, tmp_path):
    with pytest.raises(InputError, match="holds no checkpoint of a training"):
        TrainingKeeper(tmp_path, recording, config, resume=True)
    with pytest.raises(TrainingStopped):
        train_run(recording, config, keeper=Stopping(tmp_path, recording, config, after=1))
    other = load_config(None, ["seed=5"])
    with pytest.raises(InputError, match="training with other config"):
        TrainingKeeper(tmp_path, recording, other, resume=True)
    with pytest.raises(InputError, match="training with other frames"):
        TrainingKeeper(tmp_path, recording.select(range(3)), config, resume=True)


def start(data: Path, out: Path, *more: str) -> subprocess.Popen:
    command = [sys.executable, "-c", "import sys; from horizon_dl.cli import main; sys.exit(main())"]
    return subprocess.Popen(
        [*command, "train", str(data), "--out", str(out), *OPTIONS, *more],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_verb_survives_signals(tmp_path, how):
    data = write_toy_set(tmp_path / "set", frames=30)
    out, long = tmp_path / "run", ["--train.rounds", "[3, 120]"]
    running = start(data, out, *long)
    while not (out / CHECKPOINT).exists() and running.poll() is None:
        time.sleep(0.05)
    time.sleep(0.5)
    os.kill(running.pid, how)
    _, said = running.communicate(timeout=60)
    if how == signal.SIGKILL:
        assert running.returncode == -how
    else:
        assert running.returncode == 1
        assert "with --resume goes on" in said
        assert "Traceback" not in said
        assert not list(out.glob(".horizon-dl-*"))
    assert main(["train", str(data), "--out", str(out), *OPTIONS, *long]) == 2
    assert main(["train", str(data), "--out", str(out), *OPTIONS, *long, "--resume"]) == 0
    assert not (out / CHECKPOINT).exists()
    assert not list(out.glob(".*"))
    other = tmp_path / "other"
    assert main(["train", str(data), "--out", str(other), *OPTIONS, *long]) == 0
    ours, theirs = (load_file(folder / "weights.safetensors") for folder in (out, other))
    assert all(tensor.equal(theirs[name]) for name, tensor in ours.items())
