"""How loud the command line is: `--quiet`, `-v`, `--json`, colours, and progress without a terminal."""

import io
import json
import os
from pathlib import Path

import numpy as np
import pytest
from toy import write_toy_set

from horizon_dl import progress
from horizon_dl.cli import PRINTING, VERBS, main, parse
from horizon_dl.cli.console import coloured, with_level
from horizon_dl.progress import Lines, show_progress

QUICK = ["--train.rounds", "[12, 11]", "--train.batch", "4", "--train.crop", "32", "--model.samples", "4"]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture(scope="module")
def toy(tmp_path_factory) -> Path:
    return write_toy_set(tmp_path_factory.mktemp("toy") / "set", frames=24)


@pytest.fixture(scope="module")
def trained(toy, tmp_path_factory) -> tuple[Path, dict]:
    """A run, and what `train --json` said of it on standard output."""
    out, printed = tmp_path_factory.mktemp("run") / "run", io.StringIO()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.stdout", printed)
        assert main(["train", str(toy), "--out", str(out), "--json", *QUICK]) == 0
    return out, json.loads(printed.getvalue())


@pytest.mark.parametrize("verb", sorted(set(VERBS) - set(PRINTING)))
def test_every_verb_that_works_has_the_three_options(verb, capsys):
    with pytest.raises(SystemExit):
        parse([verb, "--help"])
    said = capsys.readouterr().out
    assert all(option in said for option in ("--quiet", "--verbose", "--json"))


def test_json_is_the_one_thing_on_standard_output(trained):
    out, said = trained
    assert said["verb"] == "train"
    assert said["exit_code"] == 0
    assert (said["out"], said["data"], said["frames"]) == (str(out), "set", 24)
    assert said["threshold"] == json.loads((out / "run.json").read_text())["threshold"]


def test_json_says_what_went_wrong_too(capsys):
    assert main(["check-data", "nowhere", "--json"]) == 2
    printed = capsys.readouterr()
    said = json.loads(printed.out)
    assert (said["verb"], said["exit_code"]) == ("check-data", 2)
    assert said["error"] in printed.err


@pytest.mark.parametrize("place", [["data", "--json", "list"], ["data", "list", "--json"]])
def test_an_action_takes_the_options_on_either_side(place, capsys):
    assert main(place) == 0
    assert len(json.loads(capsys.readouterr().out)["sets"]) > 3


def test_quiet_leaves_errors_alone_and_puts_everything_back(toy, capsys, monkeypatch):
    monkeypatch.delenv("TQDM_DISABLE", raising=False)
    assert main(["check-data", str(toy), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert "TQDM_DISABLE" not in os.environ
    assert main(["check-data", "nowhere", "--quiet"]) == 2
    assert "does not exist" in capsys.readouterr().err


def test_verbose_says_versions_changes_and_time(toy, capsys):
    assert main(["check-data", str(toy), "-v", "--labels.band_deg", "2"]) == 0
    said = capsys.readouterr().err
    assert "numpy " in said
    assert "config: labels.band_deg 2.0" in said
    assert "check-data took" in said
    assert main(["data", "list"]) == 0
    assert "took" not in capsys.readouterr().err


def test_verbose_shows_where_a_failure_happened(toy, capsys, monkeypatch):
    def fail(*_, **__):
        raise RuntimeError("no luck")

    monkeypatch.setattr("horizon_dl.inspection.data_check.check_recording", fail)
    assert main(["check-data", str(toy), "-v"]) == 1
    assert "Traceback" in capsys.readouterr().err
    assert main(["check-data", str(toy)]) == 1
    said = capsys.readouterr().err
    assert "Traceback" not in said
    assert "-v shows where" in said


def test_colours_are_for_terminals_and_no_color_is_honoured(monkeypatch):
    for name in ("NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    assert coloured("dark", "warning", Terminal()) == "\x1b[33mdark\x1b[0m"
    assert coloured("dark", "warning", io.StringIO()) == "dark"
    assert with_level("problem  no light", Terminal()) == "\x1b[31mproblem\x1b[0m  no light"
    assert with_level("no level", Terminal()) == "no level"
    monkeypatch.setenv("TERM", "dumb")
    assert coloured("dark", "warning", Terminal()) == "dark"
    monkeypatch.delenv("TERM")
    monkeypatch.setenv("NO_COLOR", "1")
    assert coloured("dark", "warning", Terminal()) == "dark"


def test_piped_progress_is_plain_lines_at_times(monkeypatch, capsys):
    monkeypatch.delenv("TQDM_DISABLE", raising=False)
    now = iter(np.arange(0, 100, 1.5))  # asked for at the beginning, at every step, and after every line
    monkeypatch.setattr(progress.time, "monotonic", lambda: float(next(now)))
    assert list(show_progress(range(12), "round 1 of 3, training", unit="step")) == list(range(12))
    said = capsys.readouterr().err
    assert said.splitlines() == [
        "round 1 of 3, training: 2 of 12 steps",
        "round 1 of 3, training: 9 of 12 steps",
        "round 1 of 3, training: 12 of 12 steps",
    ]
    assert "\r" not in said


def test_work_that_is_done_at_once_or_never_begins_is_told_by_its_result_alone(monkeypatch, capsys):
    monkeypatch.delenv("TQDM_DISABLE", raising=False)
    assert list(show_progress(range(5), "images", unit="image")) == list(range(5))
    with pytest.raises(ValueError, match="no address"), show_progress(what="online", unit="frame"):
        raise ValueError("no address")
    assert capsys.readouterr().err == ""


def test_lines_tell_figures_bytes_and_an_end_once(monkeypatch, capsys):
    monkeypatch.setattr(progress, "FIRST_LINE_S", 0.0)
    with Lines(None, "film.zip", 2_000_000, "B") as bar:
        bar.set_postfix(loss="0.6", refresh=False)
        bar.update(2_000_000)
    bar.close()
    assert capsys.readouterr().err.splitlines()[-1] == "film.zip: 2.0 of 2.0 MB, loss 0.6"
    with Lines(None, "online", None, "frame") as bar:
        bar.update()
    assert capsys.readouterr().err.splitlines() == ["online: 1 frame"]


def test_a_bar_is_for_terminals_and_can_be_silenced(monkeypatch):
    monkeypatch.delenv("TQDM_DISABLE", raising=False)
    monkeypatch.setattr("sys.stderr", Terminal())
    assert "50%" in str(show_progress(what="train", total=4, initial=2))
    monkeypatch.setenv("TQDM_DISABLE", "1")
    assert show_progress([1], "train").disable


def test_curves_go_on_over_the_rounds_and_have_pictures(trained):
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(trained[0] / "tensorboard"))
    events.Reload()
    assert [event.step for event in events.Scalars("loss")] == [9, 21]  # from 0, over both rounds
    rates = [event.value for event in events.Scalars("learning_rate")]
    assert all(0 < rate <= 0.003 for rate in rates)
    for name in ("horizon_accuracy", "auc", "auc_within_depression"):
        found = events.Scalars(name)
        assert [event.step for event in found] == [12, 23]
        assert all(0 <= event.value <= 1 for event in found)
    pictures = events.Tags()["images"]
    assert len(pictures) == 3
    assert len(events.Images(pictures[0])) == 2


def test_another_logger_is_a_config_line(toy, tmp_path, capsys):
    out = tmp_path / "run"
    short = ["--train.rounds", "[10]", "--logger.kind", "csv", *QUICK[2:]]
    assert main(["train", str(toy), "--out", str(out), "-q", *short]) == 0
    assert not (out / "tensorboard").exists()
    head = (out / "csv" / "metrics.csv").read_text().splitlines()[0].split(",")
    assert {"loss", "learning_rate", "horizon_accuracy", "auc_within_depression"} <= set(head)


def test_a_logger_that_is_not_installed_is_one_line(toy, tmp_path, capsys, monkeypatch):
    def missing(*_):
        raise ModuleNotFoundError("No module named 'wandb'", name="wandb")

    monkeypatch.setitem(__import__("horizon_dl.training.loggers", fromlist=["_"])._MAKERS, "wandb", missing)
    arguments = ["train", str(toy), "--out", str(tmp_path / "run"), "--logger.kind", "wandb", *QUICK]
    assert main(arguments) == 2
    assert "wandb needs wandb; pip install wandb" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("kind", ["wandb", "mlflow"])
def test_pictures_reach_the_loggers_that_have_ways_of_their_own(kind):
    """Their packages are large, so stand-ins with the calls that Lightning documents take their place."""
    from horizon_dl.training.loggers import log_picture

    told = []

    class Experiment:
        def log_image(self, run, picture, name):
            told.append((run, picture.shape, name))

    class MLflow:
        experiment, run_id = Experiment(), "7"

    class Wandb:
        def log_image(self, name, pictures, step):
            told.append((name, pictures[0].shape, step))

    log_picture(Wandb() if kind == "wandb" else MLflow(), "frames/a", np.zeros((4, 6, 3), np.uint8), 12)
    expected = ("frames/a", (4, 6, 3), 12) if kind == "wandb" else ("7", (4, 6, 3), "frames/a/000012.png")
    assert told == [expected]
