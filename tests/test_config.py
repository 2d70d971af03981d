import argparse
import os
import time
from pathlib import Path

import pytest
import yaml

from horizon_dl.cli.options import add_config, resolve_config
from horizon_dl.config import Config, load_config, save_config
from horizon_dl.config_file import builtin_configs
from horizon_dl.errors import InputError


def test_the_default_file_lists_every_value_and_agrees_with_the_code():
    written = yaml.safe_load((Path(__file__).parent.parent / "configs" / "default.yaml").read_text())
    assert written == Config().model_dump(mode="json")


def test_every_builtin_config_loads():
    assert "default" in builtin_configs()
    for name in builtin_configs():
        load_config(name)


def test_overrides_go_on_top_and_survive_a_round_trip(tmp_path):
    config = load_config(None, ["train.rounds=[7]", "target.kind=guided", "model.dropout=0.5"])
    assert (config.train.rounds, config.target.kind, config.model.dropout) == ((7,), "guided", 0.5)
    save_config(config, tmp_path / "c.yaml")
    assert load_config(tmp_path / "c.yaml") == config


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("train.stepz=7", "has no key 'train.stepz'"),
        ("train.batch=0", "train.batch = 0"),
        ("train.batch=many", "train.batch = 'many'"),
        ("target.kind=soft", "target.kind = 'soft'"),
        ("seed.x=1", "'seed' is a value"),
        ("train.rounds=[1, 2", "--train.rounds: its value is not valid YAML"),
        ("train.batch=" + "9" * 400, "train.batch = a number of many digits"),
        ("train.batch=" + "9" * 5000, "a number of more than 400 digits"),
        ("train.learning_rate=.inf", "train.learning_rate = inf"),
        ("model.dropout=" + "[" * 300, "--model.dropout: its value is"),
        ("train=3", "train = 3"),
        ("train..x=3", "has no key 'train.'"),
        ("seed=99999999999", "seed = 99999999999"),
        ("train.batch=&a [*a]", "a value holds itself"),
        ("train.batch=", "train.batch = None"),
    ],
)
def test_a_wrong_value_is_named(override, words):
    with pytest.raises(InputError, match="; ") as error:
        load_config(None, [override])
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("text", ["a: [1", "- 1\n- 2\n", "nonsense: 1"])
def test_a_wrong_file_is_named(tmp_path, text):
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(InputError, match=r"c\.yaml"):
        load_config(tmp_path / "c.yaml")


def bomb(levels: int = 30) -> str:
    """Each line stands for ten of the one before."""
    lines = ["a0: &a0 x"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, levels)]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (bomb(), "more than 12000 values"),
        (bomb() + "\ntrain: {batch: *a29}", "more than 12000 values"),
        ("a: &a {b: 1}\nc: &c {<<: [*a, *a]}\n" + bomb(), "more than 12000 values"),
        ("{a: " * 100_000, "is larger than 256 KB"),
        ("[" * 20_000, "nested deeper"),
        ("[" + "1," * 100_000, "more than 12000 values"),
        ("a: " + "word " * 50_000, "has no key 'a'"),
        ("a: " + "1:" * 100_000 + "1", "more than 400 digits"),
        ("? [1, 2]\n: 3", "is not valid YAML"),
        ("a: !!python/object/apply:os.system [ls]", "is not valid YAML"),
        ("a: 2001-99-99", "a value cannot be read"),
    ],
)
def test_files_that_grow_are_refused_at_once(tmp_path, text, words):
    (tmp_path / "c.yaml").write_text(text)
    start = time.process_time()
    with pytest.raises(InputError, match=words) as error:
        load_config(tmp_path / "c.yaml")
    assert time.process_time() - start < 2
    assert len(str(error.value)) < 1000
    assert "\n" not in str(error.value)


def test_a_pipe_is_no_config(tmp_path):
    os.mkfifo(tmp_path / "c.yaml")
    with pytest.raises(InputError, match="is a pipe or device"):
        load_config(tmp_path / "c.yaml")


def test_unknown_names_and_missing_files():
    with pytest.raises(InputError, match="no built-in config"):
        load_config("nothing")
    with pytest.raises(InputError, match="cannot be read"):
        load_config("nothing.yaml")


def test_the_seed_is_an_option_of_its_own():
    parser = argparse.ArgumentParser()
    add_config(parser)
    for words, seed in (([], 4), (["--seed", "3"], 3)):
        arguments = parser.parse_args(words)
        arguments.overrides = ["seed=4"]
        assert resolve_config(arguments).seed == seed
    arguments.seed = "three"
    with pytest.raises(InputError, match="seed"):
        resolve_config(arguments)
