"""TUM RGB-D: `rgb.txt`, `groundtruth.txt`, `depth.txt`; also ICL-NUIM, and trajectories of others.

The ground truth holds quaternions x y z w, camera optical to a world with z up. Source: Sturm et al.,
A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.calibration.picture_size import picture_size
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, RangeUnit, image_recording
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.columns import TIME_UNITS
from horizon_dl.data.tables.parsing import (
    by_time,
    check_overlap,
    inside_folder,
    quaternion_places,
    read_lines,
    read_numbers,
    usable_quaternions,
)
from horizon_dl.data.tables.units import epoch_unit
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import MAX_GAP_S, bracket, interpolate, rotation_from_quaternion, unit
from horizon_dl.geometry.camera import Camera
from horizon_dl.readers.beside import files_beside
from horizon_dl.readers.tum_lists import (
    Listed,
    find_depths,
    find_images,
    find_trajectory,
    found_images,
    has_lists,
)
from horizon_dl.readers.world_axes import Z_UP, World, find_world

Floats = NDArray[np.float64]

NAME = "tum"
NEEDS = "rgb.txt and groundtruth.txt"
MAX_DEPTH_OFFSET_S = 0.05
FRAME_RATE_HZ = 30.0
"""Of the data sets whose lists hold the number of a frame in place of its time."""

RANGE_UNIT = RangeUnit(1 / 5000, "axis")

# Published ROS calibrations of the colour cameras (the data set's page, "intrinsic camera calibration").
CAMERAS = {
    "freiburg1": Camera(
        "radtan", 640, 480, 517.3, 516.5, 318.6, 255.3, (0.2624, -0.9531, -0.0054, 0.0026, 1.1633)
    ),
    "freiburg2": Camera(
        "radtan", 640, 480, 520.9, 521.0, 325.1, 249.7, (0.2312, -0.7849, -0.0033, -0.0001, 0.9172)
    ),
    "freiburg3": Camera("pinhole", 640, 480, 535.4, 539.2, 320.1, 247.6),
    "icl-nuim": Camera("pinhole", 640, 480, 481.2, 480.0, 319.5, 239.5),
}


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return has_lists(folder)


def read(folder: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens one sequence.

    Raises:
        InputError: a file is missing, the camera is not known, or trajectory and images never meet in time.
    """
    truth = find_trajectory(folder) or folder / "groundtruth.txt"
    samples = read_numbers(truth, 8)
    w, x, y, z = quaternion_places(truth, 4, "xyzw")
    samples = samples[:, [0, 1, 2, 3, x, y, z, w]]
    images = find_images(folder)
    if not images:
        raise InputError(folder / "rgb.txt", "is missing or empty", f"needed: {NEEDS}")
    images = _in_seconds(found_images(folder, images))
    times, poses = by_time(_seconds_of(samples[:, 0]), samples[:, 1:])
    usable = usable_quaternions(poses[:, 3:7])
    times, poses = times[usable], poses[usable]
    check_overlap(truth, np.array([time_s for time_s, _ in images]), times)
    counted = _counts_frames([time_s for time_s, _ in images]) and _counts_frames(times.tolist())
    world = find_world(poses, certain=counted or truth.suffix == ".freiburg")
    calibration = find_camera(folder, truth, given, [folder / name for _, name in images])
    names = [name for _, name in images]
    truths = files_beside(folder, "labels", names)
    depths = _in_seconds(find_depths(folder))
    frames = []
    for index, (time_s, name) in enumerate(images):
        seconds = time_s / FRAME_RATE_HZ if counted else time_s
        header = FrameHeader(
            name,
            seconds,
            *pose_at(times, poses, time_s, world),
            as_read=_numbers_at(times, poses, time_s),
        )
        depth = nearest_depth(folder, depths, time_s)
        image = inside_folder(folder / "rgb.txt", folder, name)
        frames.append((header, FrameFiles(image, truths[index], depth)))
    note = f"frames are numbered, not timed: {FRAME_RATE_HZ:g} a second are taken"
    return image_recording(
        folder.resolve().name,
        NAME,
        calibration.camera,
        frames,
        where=truth,
        attitude_from=truth.name,
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        range_unit=RANGE_UNIT,
        reading=reading_with(_convention(world), (0.0, 0.0, 0.0)),
        notes=(*calibration.notes, *([note] if counted else []), *([world.note] if world.note else [])),
    )


def pose_at(
    times_s: Floats, poses: Floats, time_s: float, world: World = Z_UP
) -> tuple[Floats | None, float | None, float | None]:
    """Up in the camera (3,), yaw (rad) and height (m) at a time; None outside of the trajectory.

    Args:
        times_s: (N,) s.
        poses: (N, 7) tx ty tz qx qy qz qw.
        time_s: s.
        world: its axes and the camera's.
    """
    place = bracket(times_s, time_s, MAX_GAP_S)
    attitude = interpolate(times_s, poses[:, [6, 3, 4, 5]], time_s, MAX_GAP_S)
    if place is None or attitude is None:
        return None, None, None
    height = float(np.interp(time_s, times_s, poses[:, :3] @ world.up))
    world_from_cam = rotation_from_quaternion(attitude)
    return unit(world.optical(world_from_cam.T @ world.up)), world.yaw(world_from_cam[:, 2]), height


def _in_seconds(listed: Listed) -> Listed:
    """A list whose times may be Unix time in another unit."""
    seconds = _seconds_of(np.array([time for time, _ in listed]))
    return [(time_s, name) for time_s, (_, name) in zip(seconds.tolist(), listed, strict=True)]


def _seconds_of(stamps: Floats) -> Floats:
    # Divided by a whole number: the product with 1e-9 is not the same number for two lists of one clock.
    return stamps / round(1 / TIME_UNITS[epoch_unit(stamps) or "s"])


def _convention(world: World) -> Convention:
    return Convention("ruf" if world.camera_y_up else "rdf", "y" if world.up[1] else "z", "xyzw")


def _numbers_at(times_s: Floats, poses: Floats, time_s: float) -> tuple[float, ...] | None:
    """The quaternion in the file's order at a time; what order that is does not matter to the mean of two."""
    numbers = interpolate(times_s, poses[:, 3:7], time_s, MAX_GAP_S)
    return None if numbers is None else tuple(numbers.tolist())


def nearest_depth(folder: Path, depths: list[tuple[float, str]], time_s: float) -> Path | None:
    """The depth image nearest in time, if near enough and there."""
    if not depths:
        return None
    depth_time, name = min(depths, key=lambda pair: abs(pair[0] - time_s))
    path = inside_folder(folder / "depth.txt", folder, name)
    return path if abs(depth_time - time_s) <= MAX_DEPTH_OFFSET_S and path.is_file() else None


def _counts_frames(times: list[float]) -> bool:
    """Whether times are numbers of frames: whole ones, from about zero, by one."""
    if len(times) < 2 or not 0 <= times[0] < 1e6:
        return False
    whole = all(time == int(time) for time in times)
    return whole and float(np.median(np.diff(sorted(times)))) == 1.0


def find_camera(folder: Path, truth: Path, given: Given, pictures: Sequence[Path] = ()) -> Calibration:
    """From --camera or camera.yaml, else the published one of the set that comments or names tell of.

    Raises:
        InputError: neither is there.
    """
    if given.camera is not None or (folder / "camera.yaml").is_file():
        path = given.camera or folder / "camera.yaml"
        return read_calibration(path, size=picture_size(pictures), imu_axes=given.imu_axes)
    lists = [path for path in (folder / "rgb.txt", truth) if path.is_file()]
    comments = [line for path in lists for line in read_lines(path) if line.startswith("#")]
    told = "icl-nuim" if truth.suffix == ".freiburg" else ""
    text = " ".join([*comments, folder.resolve().name, told]).lower()
    for name, camera in CAMERAS.items():
        if name in text:
            return Calibration(camera)
    raise InputError(folder, "has no camera.yaml and names no freiburg camera", "add a camera.yaml")
