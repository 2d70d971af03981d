"""Wrong paths are told at once, results are not replaced unasked, and strangers' names stay harmless."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from toy import write_toy_set

from horizon_dl import processes
from horizon_dl.cli import main
from horizon_dl.output.manifest import MANIFEST

WRONG = [
    ["train", "nowhere", "--out", "out"],
    ["online", "nowhere", "--out", "out"],
    ["compare", "nowhere", "--out", "out"],
    ["evaluate", "nowhere", ".", "--out", "out"],
    ["evaluate", ".", ".", "--out", "out"],
    ["predict", "nowhere", ".", "--out", "out"],
    ["predict", ".", ".", "--out", "out"],
    ["export", "nowhere", "--out", "out"],
    ["export", ".", "--out", "out"],
    ["benchmark", "nowhere.onnx"],
    ["fly", "nowhere.onnx", "--source", ".", "--mavlink", "udpout:127.0.0.1:9"],
    ["check-data", "nowhere"],
    ["calibrate-mount", "nowhere"],
]
FULL = [
    ["train", "set", "--out", "thesis"],
    ["online", "set", "--out", "thesis"],
    ["compare", "set", "--out", "thesis"],
    ["check-data", "set", "--out", "thesis"],
    ["calibrate-mount", "set", "--out", "thesis"],
    ["demo", "--out", "thesis"],
    ["data", "simulate", "--out", "thesis"],
]
HEAVY = {"torch", "onnxruntime", "lightning", "sklearn", "kornia", "matplotlib"}


def in_new_process(code: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent.parent), **environment},
        capture_output=True,
        text=True,
        timeout=120,
    )


def test_a_wrong_path_is_told_before_anything_heavy_is_loaded(tmp_path):
    code = (
        "import sys, time\nfrom horizon_dl.cli import main\n"
        f"for words in {WRONG!r}:\n"
        "    start = time.process_time()\n"
        "    assert main(words) == 2, words\n"
        f"    heavy = {HEAVY!r} & set(sys.modules)\n"
        "    assert not heavy, (words, heavy)\n"
        "    assert time.process_time() - start < 1, words\n"
    )
    done = in_new_process(code, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("horizon-dl: ") == done.stderr.count("\n") == len(WRONG)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", FULL, ids=lambda words: words[0])
def test_a_folder_of_something_else_is_refused(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    write_toy_set(tmp_path / "set", frames=12)
    (tmp_path / "thesis" / "logs").mkdir(parents=True)
    for name in ("frames.jsonl", "config.yaml", "logs/mine"):
        (tmp_path / "thesis" / name).write_text("years of work")
    more = ["--restart"] if words[0] == "online" else []
    assert main([*words, *more]) == 2
    assert "thesis: " in capsys.readouterr().err
    held = sorted(path.relative_to(tmp_path / "thesis").as_posix() for path in tmp_path.glob("thesis/**/*"))
    assert held == ["config.yaml", "frames.jsonl", "logs", "logs/mine"]
    assert (tmp_path / "thesis" / "frames.jsonl").read_text() == "years of work"


def test_a_second_check_is_refused_unless_told(tmp_path, capsys):
    data, out = write_toy_set(tmp_path / "set", frames=12), tmp_path / "out"
    assert main(["check-data", str(data), "--out", str(out)]) == 0
    (out / "notes.txt").write_text("mine")
    assert main(["check-data", str(data), "--out", str(out)]) == 2
    assert "holds results of `check-data` already" in capsys.readouterr().err
    assert main(["check-data", str(data), "--out", str(out), "--overwrite"]) == 0
    assert (out / "notes.txt").read_text() == "mine"
    assert (out / MANIFEST).is_file()


def test_a_name_cannot_move_the_cursor(tmp_path, capsys):
    evil = tmp_path / "a\x1b[2J\x1b]0;owned\x07b"
    assert main(["check-data", str(evil)]) == 2
    write_toy_set(evil, frames=3)
    (evil / "frames.csv").write_text("image,time_s,roll_rad,pitch_rad\n\x1b[31m.png,\x1b[2J,0,0\n")
    assert main(["check-data", str(evil)]) == 2
    said = capsys.readouterr().err
    assert said.replace("\n", "").isprintable()
    assert "\\x1b" in said


@pytest.mark.parametrize("name", ["RANK", "LOCAL_RANK", "NODE_RANK"])
def test_a_number_left_in_the_environment_silences_nobody(tmp_path, name):
    code = "import sys; from horizon_dl.cli import main; sys.exit(main(['config', 'show']))"
    done = in_new_process(code, tmp_path, **{name: "1"})
    assert "max_pixels" in done.stdout


def test_a_launcher_makes_helpers_of_verbs_that_train(monkeypatch):
    monkeypatch.setenv("LOCAL_RANK", "1")
    monkeypatch.setenv("MASTER_ADDR", "127.0.0.1")
    processes.begin("train")
    assert processes.is_helper()
    processes.begin("config")
    assert not processes.is_helper()


def test_sigterm_leaves_nothing(tmp_path):
    data = write_toy_set(tmp_path / "set", frames=40)
    code = (
        "import sys, time\nfrom horizon_dl.cli import main\nimport horizon_dl.inspection.data_check as d\n"
        "real = d.check_recording\n"
        "import horizon_dl.reporting.check as r\n"
        "def slow(*a, **k):\n    print('at work', flush=True)\n    time.sleep(60)\n"
        "r.write_check = slow\n"
        f"sys.exit(main(['check-data', {str(data)!r}, '--out', {str(tmp_path / 'out')!r}]))"
    )
    running = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert running.stdout is not None
    while "at work" not in running.stdout.readline():
        time.sleep(0.01)
    running.send_signal(signal.SIGTERM)
    _, said = running.communicate(timeout=30)
    assert running.returncode == 1
    assert "stopped; nothing half-written is left" in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["set"]
