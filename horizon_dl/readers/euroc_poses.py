"""Ground truths of ASL folders: `state_groundtruth_estimate0`, TUM-VI's `mocap0`, `vicon0`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.euroc import body_from_camera
from horizon_dl.calibration.fields import Fields
from horizon_dl.calibration.tree import read_tree
from horizon_dl.data.tables.columns import TIME_UNITS
from horizon_dl.data.tables.parsing import (
    by_time,
    check_overlap,
    quaternion_places,
    read_numbers,
    usable_quaternions,
)
from horizon_dl.data.tables.units import epoch_unit
from horizon_dl.geometry.attitude import MAX_GAP_S, interpolate, rotation_from_quaternion

Floats = NDArray[np.float64]

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


def seconds_of(stamps: Floats) -> Floats:
    """Stamps (N,) in s: nanoseconds, as the layout wants, unless in microseconds they are a date.

    As nanoseconds such numbers would be days since the start; those that are dates in longer units would
    be minutes.
    """
    microseconds = len(stamps) and epoch_unit(stamps) == "us"
    return stamps * TIME_UNITS["us" if microseconds else "ns"]


def find_poses(root: Path) -> Path | None:
    """The best ground truth of a sequence."""
    places = (root / name / "data.csv" for name in FOLDERS)
    return next((place for place in places if place.is_file()), None)


@dataclass(frozen=True)
class Attitudes:
    """What a ground truth tells at some times.

    Attributes:
        ups: the world's up (3,) in the IMU's axes; None outside of the data and in gaps of it.
        as_read: the quaternion w x y z, of the tracked body to the world; None as of `ups`.
        imu_from_body: rotation (3, 3) from the tracked body to the IMU's axes.
    """

    ups: list[Floats | None]
    as_read: list[tuple[float, ...] | None]
    imu_from_body: Floats


def read_attitudes(path: Path, image_times_s: Floats) -> Attitudes:
    """The attitudes at each time.

    Raises:
        InputError: the file cannot be read, or its times never meet the images'.
    """
    samples = read_numbers(path, 8)
    samples = samples[usable_quaternions(samples[:, 4:8])]
    quaternions = samples[:, quaternion_places(path, 4, "wxyz")]
    times, quaternions = by_time(seconds_of(samples[:, 0]), quaternions)
    check_overlap(path, image_times_s, times)
    attitudes = [interpolate(times, quaternions, t, MAX_GAP_S) for t in image_times_s.tolist()]
    imu_from_body = _mount(path.parent)
    ups = [None if q is None else imu_from_body @ rotation_from_quaternion(q).T @ UP_WORLD for q in attitudes]
    return Attitudes(ups, [None if q is None else tuple(q.tolist()) for q in attitudes], imu_from_body)


def _mount(folder: Path) -> Floats:
    """Rotation of the tracked body into the IMU's, where the folder's sensor.yaml tells (vicon0)."""
    path = folder / "sensor.yaml"
    if not path.is_file():
        return np.eye(3)
    fields = Fields(path, read_tree(path))
    return body_from_camera(fields) if "T_BS" in fields.content else np.eye(3)
