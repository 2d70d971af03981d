"""Training in two processes does what one does with the doubled batch."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.numpy import load_file
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from toy import write_toy_set

from horizon_dl.training.distributed import GlobalBatchNorm2d, SyncBatchNorm

QUICK = [
    "--train.rounds",
    "[12, 10]",
    "--train.crop",
    "32",
    "--model.dropout",
    "0",
    "--trainer.accelerator",
    "cpu",
]


def train(data: Path, out: Path, *options: str) -> tuple[dict[str, np.ndarray], list[float]]:
    command = [sys.executable, str(Path(sys.executable).with_name("horizon-dl")), "train", str(data)]
    done = subprocess.run(
        [*command, "--out", str(out), *QUICK, *options],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("trained on") == 1
    events = EventAccumulator(str(out / "tensorboard"))
    events.Reload()
    losses = [event.value for event in events.Scalars("loss")]
    return load_file(out / "weights.safetensors"), losses


@pytest.mark.slow
@pytest.mark.long
def test_two_processes_are_one_with_the_doubled_batch(tmp_path):
    data = write_toy_set(tmp_path / "toy")
    one, losses_of_one = train(data, tmp_path / "one", "--train.batch", "4")
    two, losses_of_two = train(
        data, tmp_path / "two", "--train.batch", "2", "--trainer.strategy", "ddp", "--trainer.devices", "2"
    )
    assert len(losses_of_one) == len(losses_of_two) >= 2
    np.testing.assert_allclose(losses_of_two, losses_of_one, rtol=1e-4)
    for name, value in one.items():
        np.testing.assert_allclose(two[name], value, atol=2e-3, err_msg=name)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "toy", "two"]


def test_exchanging_the_batch_norm_changes_nothing_in_one_process():
    net = torch.nn.Sequential(torch.nn.Conv2d(3, 4, 1), torch.nn.BatchNorm2d(4))
    image = torch.rand(2, 3, 5, 5)
    expected = net(image)
    SyncBatchNorm().apply(net)
    assert type(net[1]) is GlobalBatchNorm2d
    assert torch.equal(net(image), expected)
    SyncBatchNorm().revert(net)
    assert type(net[1]) is torch.nn.BatchNorm2d
