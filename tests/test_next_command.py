"""The hint at the next command: what it prints can be typed."""

import argparse
import shlex
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_run import model_file, toy_set

from horizon_dl.cli import main
from horizon_dl.cli.data_options import add_data
from horizon_dl.cli.next_command import data_words, next_command

WORD = st.text(st.characters(codec="ascii", exclude_characters="\0\n\r"), min_size=1)


def parsed(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_data(parser)
    return parser.parse_args(words)


@settings(max_examples=100, deadline=None)
@given(
    data=WORD.filter(lambda text: not text.startswith("-")),
    options=st.fixed_dictionaries(
        {},
        optional={
            "--format": WORD,
            "--camera": WORD,
            "--imu-axes": WORD,
            "--convention": WORD,
            "--attitude": WORD,
            "--time-offset": st.sampled_from(["auto", "0.25", "-0.125", "1.5,20"]),
            "--time-unit": st.sampled_from(["s", "ms"]),
            "--angle-unit": st.just("deg"),
            "--topic": WORD,
        },
    ),
)
def test_the_words_name_the_same_data(data: str, options: dict[str, str]) -> None:
    typed = parsed([data, *(f"{name}={value}" for name, value in options.items())])
    printed = next_command(*data_words(typed)).removeprefix("next: horizon-dl ")
    again = parsed(shlex.split(printed))
    assert vars(again) == vars(typed)


def test_only_what_was_given_is_repeated() -> None:
    assert data_words(parsed(["film.mp4"])) == ["film.mp4"]
    given = ["my film.mp4", "--attitude", "log.csv"]
    assert data_words(parsed(given)) == given


def test_frames_without_an_attitude_are_told_from_the_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = model_file()
    picture = sorted((toy_set() / "images").iterdir())[0]
    assert main(["predict", str(model), str(picture), "--out", str(tmp_path / "one")]) == 0
    assert "without an attitude there is no horizon" in capsys.readouterr().out
    assert "Without an attitude there is no horizon" in (tmp_path / "one" / "index.html").read_text()
    assert main(["predict", str(model), str(toy_set()), "--out", str(tmp_path / "all")]) == 0
    assert "without an attitude" not in capsys.readouterr().out


def test_an_attitude_without_a_camera_is_not_left_out_in_silence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model, out = model_file(), tmp_path / "out"
    picture = sorted((toy_set() / "images").iterdir())[0]
    words = ["predict", str(model), str(picture), "--out", str(out)]
    assert main([*words, "--attitude", "constant:0,0"]) == 2
    assert "--camera" in capsys.readouterr().err
    assert not out.exists()
    assert main(words) == 0
    assert "--camera and --attitude give one" in capsys.readouterr().out


def test_the_printed_command_can_be_typed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "my set"
    assert main(["data", "simulate", "--out", str(folder), "--frames", "2"]) == 0
    printed = capsys.readouterr().out.split("next: horizon-dl ")[1].splitlines()[0]
    assert main(shlex.split(printed)) in (0, 2)
    assert "my set" in capsys.readouterr().out
