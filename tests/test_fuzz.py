"""A small part of `python -m tests.fuzz`, in every run of the tests."""

from fuzz.run import run_cases

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


def test_damaged_inputs_give_documented_errors_in_bounds(tmp_path):
    found = run_cases(tmp_path, 400, seed=1, only=CHEAP)
    assert found.count == 400
    assert not found.faults, "\n".join(found.faults)
    assert sum(found.refused.values()) > 100
