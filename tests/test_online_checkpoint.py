"""Nothing lost: kills, full disks and read-only folders."""

import errno
import json
import multiprocessing
import os
import random
import resource
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import torch
from tiny_online import assert_same_run, frame_lines, tiny_options, tiny_run
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.errors import InputError
from horizon_dl.online.frame_log import FrameLog
from horizon_dl.training import checkpoint, tensor_file
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint

FRAMES = 40
KILLS = int(os.environ.get("HORIZON_DL_KILLS", "10"))
"""Four of five at a point of a checkpoint's writing, the fifth at a random moment; 100 have been survived."""
EVERY_FRAME = ("online.checkpoint_frames=1",)


@pytest.fixture(scope="module")
def toy(tmp_path_factory) -> Path:
    return write_toy_set(tmp_path_factory.mktemp("toy") / "set", frames=FRAMES)


@pytest.fixture(scope="module")
def whole(toy, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("whole") / "run"
    finish(toy, out)
    return out


def finish(data: Path, out: Path) -> None:
    run = tiny_run(data, out, *EVERY_FRAME)
    run.run()
    run.finish()


def learn_and_die(data: Path, out: Path, started, point: str, count: int) -> None:
    """A child that kills itself at a point of its `count`-th checkpoint, or is killed from outside."""
    calls = {"save": 0}
    save_file, replace = tensor_file.save_file, Path.replace

    def die() -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    def save(tensors, path, metadata) -> None:
        calls["save"] += 1
        save_file(tensors, path, metadata)
        if calls["save"] == count and point == "half":
            os.truncate(path, Path(path).stat().st_size // 2)
            die()
        if calls["save"] == count and point == "written":
            die()

    def move(self, target):
        mine = self.name.endswith(".safetensors.part") and calls["save"] == count
        if mine and point == "before rename":
            die()
        moved = replace(self, target)
        if mine and point == "after rename":
            die()
        return moved

    tensor_file.save_file, Path.replace = save, move
    started.set()
    finish(data, out)


@pytest.mark.slow
@pytest.mark.long
def test_killed_again_and_again_a_run_equals_one_that_was_not(toy, whole, tmp_path):
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["horizon_dl.online.run", "pytest"])
    chance = random.Random(0)
    points = ["half", "written", "before rename", "after rename"]
    kills = runs = 0
    while kills < KILLS:
        out = tmp_path / f"run{runs}"
        while True:
            point = points[kills % 5] if kills % 5 < 4 else ""
            started = context.Event()
            child = context.Process(
                target=learn_and_die, args=(toy, out, started, point, chance.randint(1, 4))
            )
            child.start()
            started.wait(60)
            if not point:
                time.sleep(chance.uniform(0.0, 0.4))
                child.kill()
            child.join(60)
            if child.exitcode == 0:
                break
            assert child.exitcode == -signal.SIGKILL
            kills += 1
            if (out / "checkpoint.safetensors").exists():
                read_checkpoint(out / "checkpoint.safetensors")
        assert_same_run(out, whole)
        assert not list(out.glob(".*.part"))
        runs += 1


def test_a_snapshot_comes_back(tmp_path):
    inner = Snapshot({"a": torch.arange(5), "b/c": torch.rand(2, 3)}, {"x": 0.1 + 0.2, "big": 2**120})
    write_checkpoint(tmp_path / "c", Snapshot.join({"one": inner, "two": Snapshot(values={"y": None})}))
    found = read_checkpoint(tmp_path / "c")
    assert found.part("one").values == inner.values
    assert found.part("two").values == {"y": None}
    assert all(found.part("one").tensors[name].equal(tensor) for name, tensor in inner.tensors.items())
    assert [path.name for path in tmp_path.iterdir()] == ["c"]


def test_a_checkpoint_of_another_format_is_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(checkpoint, "FORMAT", 99)
    write_checkpoint(tmp_path / "c", Snapshot())
    monkeypatch.undo()
    with pytest.raises(InputError, match="another version"):
        read_checkpoint(tmp_path / "c")


def test_no_pickle_is_in_the_file(toy, tmp_path):
    tiny_run(toy, tmp_path / "run", max_frames=2).run()
    content = (tmp_path / "run" / "checkpoint.safetensors").read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    assert set(header["__metadata__"]) == {"values", "sha256"}
    assert b"ctorch" not in content


def full_disk(*_) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_learning_goes_on_while_no_checkpoint_can_be_written(toy, whole, tmp_path, monkeypatch, capsys):
    out = tmp_path / "run"
    run = tiny_run(toy, out, *EVERY_FRAME, max_frames=20)
    real, settle = tensor_file.save_file, run.settle

    def settle_and_fill(seen) -> None:
        settle(seen)
        full = 5 <= seen.index < 12
        monkeypatch.setattr(tensor_file, "save_file", full_disk if full else real)
        if seen.index == 11:
            assert read_checkpoint(out / "checkpoint.safetensors").values["place"]["position"] == 5

    monkeypatch.setattr(run, "settle", settle_and_fill)
    run.run()
    assert run.keeper.failed == 7
    assert "no checkpoint (No space left on device); learning goes on" in capsys.readouterr().err
    assert read_checkpoint(out / "checkpoint.safetensors").values["place"]["position"] == 20
    run.keeper.close()
    finish(toy, out)
    assert_same_run(out, whole)
    assert json.loads((out / "run.json").read_text())["online"]["checkpoints_failed"] == 0


def test_a_second_learner_in_a_folder_is_one_line(toy, tmp_path, capsys):
    out = tmp_path / "run"
    first = tiny_run(toy, out, max_frames=2)
    assert main(["online", str(toy), "--out", str(out), *tiny_options()]) == 2
    assert "is written by another learner" in capsys.readouterr().err
    first.run()
    first.finish()
    assert main(["online", str(toy), "--out", str(out), *tiny_options()]) == 0


def test_a_disk_full_from_the_start_is_one_line(toy, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(tensor_file, "save_file", full_disk)
    assert main(["online", str(toy), "--out", str(tmp_path / "run"), *tiny_options()]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("horizon-dl: ")]
    assert len(lines) == 1
    assert "cannot be written (No space left on device); make room there" in lines[0]


def test_lines_wait_for_room(tmp_path):
    log = FrameLog(tmp_path / "f")
    log.add({"a": 1})
    real = log._file

    class Full:
        """Takes three bytes more."""

        def seek(self, place: int) -> None:
            real.seek(place)

        def truncate(self, size: int) -> None:
            real.truncate(size)

        def write(self, content: bytes) -> int:
            return real.write(content[:3])

    log._file = Full()  # type: ignore[assignment]
    log.add({"b": 2})
    assert (tmp_path / "f").read_text() == '{"a": 1}\n'
    with pytest.raises(OSError, match="full"):
        log.save()
    log._file = real
    log.add({"c": 3})
    log.save()
    assert [json.loads(line) for line in (tmp_path / "f").read_text().splitlines()] == [
        {"a": 1},
        {"b": 2},
        {"c": 3},
    ]
    log.close()
    FrameLog(tmp_path / "f", 9).close()
    assert (tmp_path / "f").read_text() == '{"a": 1}\n'


@pytest.fixture
def small_disk(tmp_path) -> Iterator[Path]:
    """A file system of 8 MB; only root may mount one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", str(folder)]
    if os.geteuid() or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("no file system can be mounted here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)


def test_a_disk_that_is_really_full(toy, whole, small_disk, capsys):
    out, filler = small_disk / "run", small_disk / "filler"
    run = tiny_run(toy, out, *EVERY_FRAME)
    settle = run.settle

    def settle_and_fill(seen) -> None:
        settle(seen)
        if seen.index == 5:
            fill(filler)
        if seen.index == 12:
            assert read_checkpoint(out / "checkpoint.safetensors").values["place"]["position"] <= 6
            filler.unlink()

    run.settle = settle_and_fill  # type: ignore[method-assign]
    run.run()
    assert run.keeper.failed >= 6
    assert "learning goes on" in capsys.readouterr().err
    run.finish()
    assert len(frame_lines(out)) == FRAMES
    assert_same_run(out, whole)
    fill(filler)
    arguments = ["online", str(toy), "--out", str(small_disk / "new"), *tiny_options()]
    assert main(arguments) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_a_limit_on_files_is_a_full_disk(toy, whole, tmp_path, capsys):
    """As above, without a file system of its own: from here on no file may grow over 4 KB."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    out = tmp_path / "run"
    run = tiny_run(toy, out, *EVERY_FRAME)
    settle = run.settle

    def settle_and_limit(seen) -> None:
        settle(seen)
        if seen.index in (5, 12):
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096 if seen.index == 5 else limits[0], limits[1]))

    run.settle = settle_and_limit  # type: ignore[method-assign]
    try:
        run.run()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert run.keeper.failed >= 6
    assert "learning goes on" in capsys.readouterr().err
    run.finish()
    assert_same_run(out, whole)


def test_a_file_system_that_is_really_read_only(toy, small_disk, capsys):
    out = small_disk / "run"
    tiny_run(toy, out, *EVERY_FRAME, max_frames=5).run()
    before = (out / "checkpoint.safetensors").read_bytes()
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    for folder in (out, small_disk / "new"):
        arguments = [
            "online",
            str(toy),
            "--out",
            str(folder),
            *tiny_options(**{"online.checkpoint_frames": "1"}),
        ]
        assert main(arguments) == 2
        lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("horizon-dl: ")]
        assert len(lines) == 1
        assert "Read-only file system" in lines[0]
    assert (out / "checkpoint.safetensors").read_bytes() == before


def fill(path: Path) -> None:
    """Take all the room that is left."""
    with path.open("wb", buffering=0) as file:
        for size in (65536, 1024, 1):
            try:
                while file.write(bytes(size)) == size:
                    pass
            except OSError:
                continue
