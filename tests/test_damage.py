"""Whatever bit of a checkpoint or run folder is damaged: it is found, and the file is named."""

import random
import shutil
from pathlib import Path

import pytest
import torch
from small_run import small_run_folder

from horizon_dl.cli import main
from horizon_dl.errors import InputError
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint
from horizon_dl.training.run_folder import FILES, load_run

DAMAGES = 200


def flip(path: Path, bit: int) -> bytes:
    """Damage a file; returns what it was."""
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[bit // 8] ^= 1 << bit % 8
    path.write_bytes(damaged)
    return whole


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("c") / "checkpoint.safetensors"
    tensors = {"a": torch.rand(7, 5), "random": torch.randint(0, 255, (300,), dtype=torch.uint8)}
    write_checkpoint(path, Snapshot(tensors, {"position": 5, "name": "a \"quoted\" 'name'"}))
    return path


def test_every_bit_of_a_checkpoint_counts(checkpoint):
    bits = 8 * checkpoint.stat().st_size
    chance = random.Random(0)
    for bit in [*range(0, 8 * 400), *(chance.randrange(bits) for _ in range(DAMAGES))]:
        whole = flip(checkpoint, bit)
        with pytest.raises(InputError, match=r"checkpoint\.safetensors: .*--restart"):
            read_checkpoint(checkpoint)
        checkpoint.write_bytes(whole)
    assert read_checkpoint(checkpoint).values["position"] == 5


def test_a_checkpoint_that_is_cut_off_or_grown(checkpoint):
    whole = checkpoint.read_bytes()
    for content in (b"", whole[:5], whole[:100], whole[:-1], whole + b"\0", b"\xff" * 100, whole[8:]):
        checkpoint.write_bytes(content)
        with pytest.raises(InputError, match=r"checkpoint\.safetensors: "):
            read_checkpoint(checkpoint)
    checkpoint.write_bytes(whole)


def test_every_damage_of_a_run_folder_is_found(tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(small_run_folder(), folder)
    chance = random.Random(0)
    names = [*FILES, "manifest.json"]
    for number in range(DAMAGES):
        path = folder / names[number % len(names)]
        whole = flip(path, chance.randrange(8 * path.stat().st_size))
        with pytest.raises(InputError, match="damaged"):
            load_run(folder)
        path.write_bytes(whole)
    load_run(folder)


def test_a_damaged_run_is_one_line_and_exit_code_2(tmp_path, capsys):
    folder = tmp_path / "run"
    shutil.copytree(small_run_folder(), folder)
    flip(folder / "weights.safetensors", 8 * 5000)
    assert main(["export", str(folder), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "weights.safetensors: is damaged or was altered" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_run_folder_of_an_older_version_is_still_read(tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(small_run_folder(), folder)
    (folder / "manifest.json").unlink()
    load_run(folder)
