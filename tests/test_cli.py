"""The command line as a user meets it, on a toy set."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from toy import write_toy_set

from horizon_dl.cli import VERBS, main

QUICK = ["--train.rounds", "[8, 4]", "--train.batch", "4", "--train.crop", "32", "--model.samples", "4"]
QUICK += ["--forest.training_pixels", "4000", "--online.steps_per_frame=1", "--online.batch=2"]
QUICK += ["--online.warm_up_steps=1"]
FIGURES = {"auc", "auc_within_depression", "ap", "fpr90", "fpr95", "best_f1"}
NET_SCORES = {
    "entropy",
    "single_pass_entropy",
    "expected_entropy",
    "mutual_information",
    "surprisal",
    "fused",
}


@pytest.fixture(scope="module")
def toy(tmp_path_factory) -> Path:
    return write_toy_set(tmp_path_factory.mktemp("toy") / "set", frames=30)


@pytest.fixture(scope="module")
def trained(toy, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("run") / "run"
    assert main(["train", str(toy), "--out", str(out), *QUICK]) == 0
    return out


@pytest.mark.parametrize("verb", ["", *VERBS])
def test_help_answers_without_heavy_imports(verb):
    code = (
        "import sys, horizon_dl.cli as c\n"
        f"try: c.main({[verb, '--help'] if verb else ['--help']!r})\n"
        "except SystemExit as e: assert e.code == 0\n"
        "heavy = {'torch', 'numpy', 'PIL', 'yaml', 'pydantic', 'sklearn', 'matplotlib'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "usage: horizon-dl" in done.stdout


@pytest.mark.parametrize("protocol", ["labelled-out", "tail", "prequential"])
def test_compare_writes_the_agreed_metrics(toy, tmp_path, capsys, protocol):
    out = tmp_path / "out"
    arguments = ["compare", str(toy), "--out", str(out), "--protocol", protocol, "--seeds", "2", *QUICK]
    assert main(arguments) == 0
    metrics = json.loads((out / "metrics.json").read_text())
    assert (metrics["schema"], metrics["data"], metrics["protocol"]) == (1, "set", protocol)
    assert metrics["seeds"] == [0, 1]
    assert metrics["frames"]["test"] == {"labelled-out": 3, "tail": 3, "prequential": 10}[protocol]
    methods = metrics["methods"]
    assert set(methods) == {"cnn", "rf", "diffusion", "geodesic", "position"}
    assert set(methods["cnn"]["scores"]) == NET_SCORES
    assert set(methods["rf"]["scores"]) == NET_SCORES - {"single_pass_entropy"}
    for name in ("cnn", "rf"):
        block = methods[name]
        assert 0 <= block["horizon_accuracy"] <= 1
        assert block["train_s"] > 0
        assert block["predict_ms_per_frame"] > 0
        assert set(block["operating_point"]) >= {"threshold", "tpr", "fpr", "rule"}
    for block in methods.values():
        for figures in block["scores"].values():
            assert set(figures) >= FIGURES
            assert all(0 <= figures[figure] <= 1 for figure in FIGURES)
    assert set(methods["position"]["scores"]) == {"score"}
    assert abs(methods["position"]["scores"]["score"]["auc_within_depression"] - 0.5) < 0.15
    assert (out / "report.html").stat().st_size > 10_000
    assert (out / "roc.svg").exists()
    assert list((out / "panels").glob("*.jpg"))
    assert "AUC within depression" in capsys.readouterr().out


def test_compare_repeats_its_figures(toy, tmp_path):
    found = []
    for name in ("a", "b"):
        assert main(["compare", str(toy), "--out", str(tmp_path / name), "--seeds", "1", *QUICK]) == 0
        methods = json.loads((tmp_path / name / "metrics.json").read_text())["methods"]
        found.append({method: block["scores"] for method, block in methods.items()})
    assert found[0] == found[1]


def test_a_set_without_truth_gives_pictures_but_no_figures(tmp_path):
    toy = write_toy_set(tmp_path / "set", frames=20, labels=False)
    assert main(["compare", str(toy), "--out", str(tmp_path / "out"), "--seeds", "1", *QUICK]) == 0
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert metrics["methods"]["cnn"]["horizon_accuracy"] > 0
    assert metrics["methods"]["cnn"]["scores"]["entropy"]["auc"] is None
    assert list((tmp_path / "out" / "panels").glob("*.jpg"))


def test_a_trained_net_is_evaluated_and_predicts(toy, trained, tmp_path):
    assert {path.name for path in trained.iterdir()} >= {"weights.safetensors", "config.yaml", "run.json"}
    assert main(["evaluate", str(trained), str(toy), "--out", str(tmp_path / "e")]) == 0
    metrics = json.loads((tmp_path / "e" / "metrics.json").read_text())
    assert set(metrics["methods"]["cnn"]["scores"]) == NET_SCORES
    assert main(["predict", str(trained), str(toy), "--out", str(tmp_path / "p")]) == 0
    arrays = np.load(tmp_path / "p" / "arrays" / "007.npz")
    assert arrays["p_above"].shape == (72, 96)
    assert 0 <= arrays["entropy"].min() <= arrays["entropy"].max() <= 1
    assert len(list((tmp_path / "p" / "panels").glob("*.jpg"))) == 30


def test_predict_takes_plain_pictures(toy, trained, tmp_path):
    one = toy / "images" / "003.png"
    assert main(["predict", str(trained), str(one), "--out", str(tmp_path / "one")]) == 0
    assert main(["predict", str(trained), str(one.parent), "--out", str(tmp_path / "all")]) == 0
    assert len(list((tmp_path / "all" / "arrays").iterdir())) == 30
    alone = np.load(tmp_path / "one" / "arrays" / "003.npz")["entropy"]
    among = np.load(tmp_path / "all" / "arrays" / "003.npz")["entropy"]
    assert np.array_equal(alone, among)


def test_check_data_prints_a_verdict_and_writes_overlays(toy, tmp_path, capsys):
    assert main(["check-data", str(toy), "--out", str(tmp_path / "c")]) == 0
    assert (tmp_path / "c" / "index.html").exists()
    assert list((tmp_path / "c" / "overlays").glob("*.jpg"))
    assert "horizon" in capsys.readouterr().out


def test_config_shows_and_copies(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["config", "show"]) == 0
    assert "max_pixels" in capsys.readouterr().out
    assert main(["config", "copy", "default"]) == 0
    assert main(["config", "copy", "default"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["config", "show", "nothing"]) == 2


def test_data_lists_the_public_sets(capsys):
    assert main(["data", "list"]) == 0
    assert "kitti" in capsys.readouterr().out.lower()


def break_column(folder):
    csv = folder / "frames.csv"
    csv.write_text(csv.read_text().replace("pitch_rad", "tilt"))


def break_attitude(folder):
    csv = folder / "frames.csv"
    head, *rows = csv.read_text().splitlines()
    broken = [",".join([*row.split(",")[:2], "nan", "nan", *row.split(",")[4:]]) for row in rows]
    csv.write_text("\n".join([head, *broken]) + "\n")


def break_most_images(folder):
    for path in sorted((folder / "images").iterdir())[:20]:
        path.write_bytes(path.read_bytes()[:200])


def break_size(folder):
    for path in (folder / "images").iterdir():
        Image.open(path).resize((50, 50)).save(path)


def break_camera(folder):
    camera = folder / "camera.yaml"
    camera.write_text("\n".join(line for line in camera.read_text().splitlines() if "fx" not in line))


def break_everything(folder):
    for path in sorted(folder.rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (break_column, ("frames.csv", "pitch_rad")),
        (break_attitude, ("frames.csv", "attitude")),
        (break_most_images, ("most images cannot be read", "truncated")),
        (break_size, ("50x50", "96x72")),
        (break_camera, ("camera.yaml", "fx")),
        (break_everything, ("is empty",)),
    ],
)
@pytest.mark.parametrize("verb", ["train", "compare"])
def test_broken_input_is_one_clear_line(tmp_path, capfd, damage, words, verb):
    folder = write_toy_set(tmp_path / "set", frames=24)
    damage(folder)
    assert main([verb, str(folder), "--out", str(tmp_path / "out"), *QUICK]) == 2
    last = [line for line in capfd.readouterr().err.splitlines() if line.startswith("horizon-dl: ")]
    assert len(last) == 1
    assert all(word in last[0] for word in words), last[0]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["set"]


def test_a_few_unreadable_frames_are_counted_not_fatal(tmp_path, capsys):
    folder = write_toy_set(tmp_path / "set", frames=30)
    for name in ("004", "012"):
        image = folder / "images" / f"{name}.png"
        image.write_bytes(image.read_bytes()[:300])
    assert main(["compare", str(folder), "--out", str(tmp_path / "out"), "--seeds", "1", *QUICK]) == 0
    assert json.loads((tmp_path / "out" / "metrics.json").read_text())["frames"]["skipped"] == 1
    assert "left out 1 frame" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [
        ["train", "DATA"],
        ["train", "DATA", "--out", "OUT", "--protocol", "tail"],
        ["nothing"],
        [],
        ["compare", "DATA", "--out", "OUT", "--seeds", "0"],
        ["compare", "DATA", "--out", "OUT", "--protocol", "none"],
        ["data", "list", "--train.batch", "3"],
    ],
)
def test_wrong_use_exits_with_2(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["train", "nowhere", "--out", "OUT"], "does not exist"),
        (["train", "DATA", "--out", "OUT", "--train.stepz", "3"], "train.stepz"),
        (["train", "DATA", "--out", "OUT", "--format", "none"], "is not known"),
        (["evaluate", "DATA", "DATA", "--out", "OUT"], "is no run folder"),
        (["predict", "DATA", "DATA", "--out", "OUT"], "is no run folder"),
        (["data", "fetch", "nothing"], "nothing"),
    ],
)
def test_bad_input_exits_with_2(toy, tmp_path, capsys, arguments, words):
    places = {"DATA": str(toy), "OUT": str(tmp_path / "out")}
    assert main([places.get(argument, argument) for argument in arguments]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert "Traceback" not in error


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written(toy, tmp_path, capsys):
    tmp_path.chmod(0o500)
    assert main(["train", str(toy), "--out", str(tmp_path / "out")]) == 2
    assert "cannot be written" in capsys.readouterr().err
