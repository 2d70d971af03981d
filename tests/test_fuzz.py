"""A small part of `python -m tests.fuzz`, in every run of the tests, and all that it ever found."""

import contextlib
import random

import pytest
from fuzz.run import run_cases
from fuzz.targets import targets

from horizon_dl.errors import HorizonError

CHEAP = [
    "images_csv",
    "kitti",
    "paparazzi",
    "tum",
    "euroc",
    "euroc_truth",
    "image",
    "camera_file",
    "attitude",
]
CHEAP += ["config", "override", "archive", "checkpoint", "manifest", "sums"]
FOUND = [("film", "3 70"), ("ros_bag", "3 223"), ("paparazzi", "5 120"), ("images_csv", "5 196")]
"""Inputs that once gave another error, hung, or took too much."""


def test_damaged_inputs_give_documented_errors_in_bounds(tmp_path):
    found = run_cases(tmp_path, 400, seed=1, only=CHEAP)
    assert found.count == 400
    assert not found.faults, "\n".join(found.faults)
    assert sum(found.refused.values()) > 100


@pytest.mark.parametrize(("name", "seed"), FOUND)
def test_what_was_found_is_gone(tmp_path, name, seed):
    if name in ("film", "ros_bag"):
        pytest.importorskip({"film": "av", "ros_bag": "rosbags"}[name])
    target = next(one for one in targets(tmp_path) if one.name == name)
    case = target.prepare()
    with contextlib.suppress(HorizonError):
        case(random.Random(seed))
