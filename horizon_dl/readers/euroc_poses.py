"""Ground truths of ASL folders: `state_groundtruth_estimate0`, TUM-VI's `mocap0`, `vicon0`."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.euroc import body_from_camera
from horizon_dl.calibration.fields import Fields
from horizon_dl.calibration.tree import read_tree
from horizon_dl.data.tables.columns import words_of
from horizon_dl.data.tables.parsing import (
    by_time,
    check_overlap,
    read_lines,
    read_numbers,
    usable_quaternions,
)
from horizon_dl.geometry.attitude import MAX_GAP_S, interpolate, rotation_from_quaternion

Floats = NDArray[np.float64]

NANOSECOND = 1e-9
UP_WORLD = np.array([0.0, 0.0, 1.0])
FOLDERS = (
    "state_groundtruth_estimate0",
    "mocap0",
    "gt0",
    "gt",
    "groundtruth0",
    "groundtruth",
    "pose0",
    "vicon0",
)


def find_poses(root: Path) -> Path | None:
    """The best ground truth of a sequence."""
    places = (root / name / "data.csv" for name in FOLDERS)
    return next((place for place in places if place.is_file()), None)


def read_ups(path: Path, image_times_s: Floats) -> list[Floats | None]:
    """The world's up in the body at each time; None outside of the data and in gaps of it.

    Raises:
        InputError: the file cannot be read, or its times never meet the images'.
    """
    samples = read_numbers(path, 8)
    samples = samples[usable_quaternions(samples[:, 4:8])]
    quaternions = samples[:, [4 + place for place in _order(path)]]
    times, quaternions = by_time(samples[:, 0] * NANOSECOND, quaternions)
    check_overlap(path, image_times_s, times)
    attitudes = (interpolate(times, quaternions, t, MAX_GAP_S) for t in image_times_s.tolist())
    body_from_sensor = _mount(path.parent)
    return [
        None if q is None else body_from_sensor @ rotation_from_quaternion(q).T @ UP_WORLD for q in attitudes
    ]


def _order(path: Path) -> tuple[int, ...]:
    """Places of w, x, y, z among the quaternion's columns: as the header says, else w first."""
    header = next((line for line in read_lines(path)[:5] if line.lstrip().startswith("#")), "")
    last = [(words_of(cell.split("[")[0]) or [""])[-1][-1:] for cell in header.split(",")[4:8]]
    return tuple(last.index(one) for one in "wxyz") if sorted(last) == ["w", "x", "y", "z"] else (0, 1, 2, 3)


def _mount(folder: Path) -> Floats:
    """Rotation of the tracked body into the IMU's, where the folder's sensor.yaml tells (vicon0)."""
    path = folder / "sensor.yaml"
    if not path.is_file():
        return np.eye(3)
    fields = Fields(path, read_tree(path))
    return body_from_camera(fields) if "T_BS" in fields.content else np.eye(3)
