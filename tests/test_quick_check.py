"""No verb learns from what cannot work: the quick part of the data check."""

from pathlib import Path
from typing import Any

import make_sets
import numpy as np
import pytest
from PIL import Image

from horizon_dl.cli import main
from horizon_dl.inspection.quick_check import quick_check
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set

BAND_RAD = 0.035
VERBS = ["train", "compare", "online"]


def flight(folder: Path, pitch: str = "0.0", frames: int = 60, *, dark: bool = False) -> Path:
    rows = [f"{i}.png,{i / 10},0.0,{pitch},0.0,1" for i in range(frames)]
    make_sets.images_csv(folder, rows)
    rng = np.random.default_rng(0)
    for index in range(frames):
        picture = rng.integers(0, 4 if dark else 255, (24, 32, 3), dtype=np.uint8)
        Image.fromarray(picture).save(folder / f"{index}.png")
    return folder


def test_good_data_passes() -> None:
    check = quick_check(open_recording(embedded_set()), BAND_RAD)
    assert check.level == "ok"
    assert check.sampled == 12


@pytest.mark.parametrize(
    ("pitch", "words"),
    [("-1.4", "only what lies below it"), ("1.4", "only what lies above it"), ("0.0", "")],
)
def test_the_horizon_has_to_be_in_view(tmp_path: Path, pitch: str, words: str) -> None:
    check = quick_check(open_recording(flight(tmp_path, pitch)), BAND_RAD)
    assert (check.level == "problem") == bool(words)
    assert words in check.verdict


def test_dark_few_or_missing_pictures(tmp_path: Path) -> None:
    dark = quick_check(open_recording(flight(tmp_path / "dark", dark=True)), BAND_RAD)
    assert "almost all images are too dark" in dark.verdict
    few = quick_check(open_recording(flight(tmp_path / "few", frames=3)), BAND_RAD)
    assert "only 3 frames can be used" in few.verdict
    folder = flight(tmp_path / "gone")
    for index in range(1, 60):
        (folder / f"{index}.png").unlink()
    assert "most images cannot be read" in quick_check(open_recording(folder), BAND_RAD).verdict


@pytest.mark.parametrize("verb", VERBS)
def test_verbs_stop_with_the_words_of_the_check(tmp_path: Path, capsys: Any, verb: str) -> None:
    folder = flight(tmp_path / "down", "-1.4")
    assert main([verb, str(folder), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "problem: The horizon is visible in 0 % of the frames." in error
    assert "down: cannot work because the horizon is almost never in the image" in error
    assert "go on with --force" in error
    assert not (tmp_path / "out").exists()


def test_force_goes_on(tmp_path: Path, capsys: Any) -> None:
    folder = flight(tmp_path / "down", "-1.4")
    quick = [
        "--online.steps_per_frame=1",
        "--online.batch=2",
        "--online.warm_up_steps=1",
        "--model.samples=4",
    ]
    arguments = ["online", str(folder), "--out", str(tmp_path / "out"), "--force", "--max-frames", "2"]
    assert main([*arguments, *quick]) == 0
    assert "problem: The horizon is visible in 0 %" in capsys.readouterr().err


def test_units_are_options_of_every_verb(tmp_path: Path, capsys: Any) -> None:
    rows = [f"{i}.png,{100 * i},0.0,{'-80'},0.0" for i in range(60)]
    folder = make_sets.images_csv(tmp_path / "ms", rows, "image,time_s,roll,pitch,yaw")
    assert main(["train", str(folder), "--out", str(tmp_path / "out")]) == 2
    assert "--time-unit ms" in capsys.readouterr().err
    arguments = ["train", str(folder), "--time-unit", "ms", "--angle-unit", "deg", "--out"]
    assert main([*arguments, str(tmp_path / "out")]) == 2
    assert "the horizon is almost never in the image" in capsys.readouterr().err
