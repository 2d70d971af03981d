"""TUM RGB-D: `rgb.txt`, `groundtruth.txt`, `depth.txt`.

The ground truth holds quaternions x y z w, camera optical to a world with z up. Source: Sturm et al.,
A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012.
"""

import math
from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, RangeUnit, image_recording
from horizon_dl.data.readers.parsing import (
    MAX_GAP_S,
    by_time,
    check_overlap,
    inside_folder,
    label_beside,
    read_lines,
    read_numbers,
    usable_quaternions,
)
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import bracket, interpolate, rotation_from_quaternion, unit
from horizon_dl.geometry.camera import Camera

Floats = NDArray[np.float64]

NAME = "tum"
NEEDS = "rgb.txt and groundtruth.txt, as TUM RGB-D has them"
MAX_DEPTH_OFFSET_S = 0.05
RANGE_UNIT = RangeUnit(1 / 5000, "axis")
UP_WORLD = np.array([0.0, 0.0, 1.0])

# Published ROS calibrations of the colour cameras (the data set's page, "intrinsic camera calibration").
CAMERAS = {
    "freiburg1": Camera(
        "radtan", 640, 480, 517.3, 516.5, 318.6, 255.3, (0.2624, -0.9531, -0.0054, 0.0026, 1.1633)
    ),
    "freiburg2": Camera(
        "radtan", 640, 480, 520.9, 521.0, 325.1, 249.7, (0.2312, -0.7849, -0.0033, -0.0001, 0.9172)
    ),
    "freiburg3": Camera("pinhole", 640, 480, 535.4, 539.2, 320.1, 247.6),
}


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return (folder / "rgb.txt").is_file()


def read(folder: Path, _: Given = NOTHING_GIVEN) -> Recording:
    """Opens one sequence.

    Raises:
        InputError: a file is missing, the camera is not known, or trajectory and images never meet in time.
    """
    calibration = find_camera(folder)
    images = read_list(folder / "rgb.txt")
    depths = read_list(folder / "depth.txt") if (folder / "depth.txt").is_file() else []
    truth = folder / "groundtruth.txt"
    samples = read_numbers(truth, 8)
    times, poses = by_time(samples[:, 0], samples[:, 1:])
    usable = usable_quaternions(poses[:, 3:7])
    times, poses = times[usable], poses[usable]
    check_overlap(truth, np.array([time_s for time_s, _ in images]), times)
    stems = Counter(Path(name).stem for name in {name for _, name in images})
    frames = []
    for time_s, name in images:
        header = FrameHeader(name, time_s, *pose_at(times, poses, time_s))
        image = inside_folder(folder / "rgb.txt", folder, name)
        labels = label_beside(folder, "labels", name, stems)
        frames.append((header, FrameFiles(image, labels, nearest_depth(folder, depths, time_s))))
    return image_recording(
        folder.resolve().name,
        NAME,
        calibration.camera,
        frames,
        where=truth,
        attitude_from="groundtruth.txt",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        range_unit=RANGE_UNIT,
    )


def pose_at(
    times_s: Floats, poses: Floats, time_s: float
) -> tuple[Floats | None, float | None, float | None]:
    """Up in the camera (3,), yaw (rad) and height (m) at a time; None outside of the trajectory.

    Args:
        times_s: (N,) s.
        poses: (N, 7) tx ty tz qx qy qz qw.
        time_s: s.
    """
    place = bracket(times_s, time_s, MAX_GAP_S)
    attitude = interpolate(times_s, poses[:, [6, 3, 4, 5]], time_s, MAX_GAP_S)
    if place is None or attitude is None:
        return None, None, None
    height = float(np.interp(time_s, times_s, poses[:, 2]))
    world_from_cam = rotation_from_quaternion(attitude)
    forward = world_from_cam[:, 2]
    return unit(world_from_cam.T @ UP_WORLD), -float(np.arctan2(forward[1], forward[0])), height


def read_list(path: Path) -> list[tuple[float, str]]:
    """Times (s) and file names of rgb.txt or depth.txt.

    Raises:
        InputError: missing, or a line is not `time name`.
    """
    pairs = []
    for line in read_lines(path):
        if line.lstrip().startswith("#"):
            continue
        stamp, _, name = line.strip().partition(" ")
        try:
            time_s = float(stamp)
        except ValueError:
            time_s = math.nan
        if name.strip() and math.isfinite(time_s):
            pairs.append((time_s, name.strip()))
        else:
            raise InputError(path, f"holds the line {line.strip()[:40]!r}", "lines are 'time filename'")
    return pairs


def nearest_depth(folder: Path, depths: list[tuple[float, str]], time_s: float) -> Path | None:
    """The depth image nearest in time, if near enough and there."""
    if not depths:
        return None
    depth_time, name = min(depths, key=lambda pair: abs(pair[0] - time_s))
    path = inside_folder(folder / "depth.txt", folder, name)
    return path if abs(depth_time - time_s) <= MAX_DEPTH_OFFSET_S and path.is_file() else None


def find_camera(folder: Path) -> Calibration:
    """From camera.yaml, else the published one of the set that the lists' comments or the folder name.

    Raises:
        InputError: neither is there.
    """
    if (folder / "camera.yaml").is_file():
        return read_calibration(folder / "camera.yaml")
    comments = [
        line
        for name in ("rgb.txt", "groundtruth.txt")
        for line in read_lines(folder / name)
        if line.startswith("#")
    ]
    text = " ".join([*comments, folder.resolve().name]).lower()
    for name, camera in CAMERAS.items():
        if name in text:
            return Calibration(camera)
    raise InputError(folder, "has no camera.yaml and names no freiburg camera", "add a camera.yaml")
