"""A small part of `python -m tests.fuzz`, in every run of the tests, and all that it ever found."""

import contextlib
import random

import pytest
from fuzz.run import run_cases
from fuzz.targets import targets

from horizon_dl.errors import HorizonError

SLOW = {"run_folder", "model_file", "card", "film", "ros_bag", "mars", "sensor_logger", "gopro"}
FOUND = [("ulog", "200 756"), ("ulog", "1000 1700"), ("kitti", "1000 6087"), ("dataflash", "1000 7983")]
FOUND += [("dji_photos", "1000 21947"), ("camera_file", "200 2844"), ("camera_file", "1000 2396")]
"""Inputs that once gave another error, hung, or took too much."""


def test_damaged_inputs_give_documented_errors_in_bounds(tmp_path):
    cheap = [target.name for target in targets(tmp_path / "names") if target.name not in SLOW]
    found = run_cases(tmp_path, 400, seed=1, only=cheap)
    assert found.count == 400
    assert not found.faults, "\n".join(found.faults)
    assert sum(found.refused.values()) > 100


@pytest.mark.parametrize(("name", "seed"), FOUND)
def test_what_was_found_is_gone(tmp_path, name, seed):
    target = next(one for one in targets(tmp_path) if one.name == name)
    case = target.prepare()
    with contextlib.suppress(HorizonError):
        case(random.Random(seed))
