"""KITTI odometry: `sequences/NN` with `image_0` to `image_3`, `calib.txt`, `times.txt`, and `poses/NN.txt`.

Its poses start in the first camera: they do not say where gravity pulls. The mean of the car's own up over
the drive stands for it, since slopes go both ways.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.picture_size import size_of
from horizon_dl.data.attitude_log import ConstantAttitude
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import images_in, read_numbers, relative_name
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import are_rotations, unit
from horizon_dl.logs.attitude_logs.registry import read_attitude
from horizon_dl.readers.beside import files_beside
from horizon_dl.readers.kitti import CAMERA_HEIGHT_M
from horizon_dl.readers.kitti_calibration import numbers, projection_camera, read_fields
from horizon_dl.readers.kitti_times import file_numbers

Floats = NDArray[np.float64]

NAME = "kitti_odometry"
NEEDS = "image_2, calib.txt, times.txt and poses"
CAMERAS = ("2", "3", "0", "1")
NOTE = (
    "KITTI odometry does not say where gravity pulls: the mean of the car's up stands for it; "
    "look at the overlays of check-data"
)
UP_CAMERA = np.array([0.0, -1.0, 0.0])
LEAST_UP = 0.1
"""Length of the mean of unit vectors below which it is nobody's direction."""


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return (folder / "times.txt").is_file() and (folder / "calib.txt").is_file() and bool(_camera_of(folder))


def read(folder: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens one sequence.

    Raises:
        InputError: a file or field is missing, or neither poses nor a constant attitude are there.
    """
    number = _camera_of(folder)
    if not recognises(folder):
        raise InputError(folder, "holds no KITTI odometry sequence", f"needed: {NEEDS}")
    images = images_in(folder / f"image_{number}")
    calib = folder / "calib.txt"
    projection = numbers(calib, read_fields(calib), f"P{number}", 12).reshape(3, 4)
    times = read_numbers(folder / "times.txt", 1)[:, 0]
    places = file_numbers(images)
    if max(places) >= len(times):
        problem = f"has {len(times)} times, the images go to number {max(places)}"
        raise InputError(folder / "times.txt", problem, "copy it whole")
    ups, yaws, note = _ups(folder, places, len(times), given)
    names = [relative_name(image, folder) for image in images]
    truths = files_beside(folder, "labels", names)
    frames = [
        (
            FrameHeader(names[i], float(times[place]), ups[i], yaws[i], CAMERA_HEIGHT_M, UP_CAMERA),
            FrameFiles(images[i], truths[i]),
        )
        for i, place in enumerate(places)
    ]
    camera = projection_camera(calib, projection, size_of(images[0]))
    return image_recording(
        folder.resolve().name,
        NAME,
        camera,
        frames,
        where=folder,
        attitude_from="the poses",
        notes=(note,) if note else (),
    )


def _ups(
    folder: Path, places: list[int], count: int, given: Given
) -> tuple[list[Floats], list[float | None], str]:
    """Up in the camera and yaw of each image, and a note."""
    constant = None if given.attitude is None else read_attitude(given.attitude, given)
    if isinstance(constant, ConstantAttitude):
        up = constant.header("", 0.0, (0.0, 0.0, 0.0)).up_cam
        return [UP_CAMERA if up is None else up] * len(places), [None] * len(places), ""
    path = _poses_of(folder)
    rotations = read_numbers(path, 12).reshape(-1, 3, 4)[:, :, :3]
    if len(rotations) != count:
        raise InputError(path, f"has {len(rotations)} poses for {count} times", "give those of the sequence")
    turns = are_rotations(rotations)
    if not turns.all():
        raise InputError(path, f"pose {int(np.argmin(turns)) + 1} is no rotation", "copy the file again")
    mean = np.mean(rotations @ UP_CAMERA, axis=0)
    if np.linalg.norm(mean) < LEAST_UP:
        raise InputError(path, "turns all ways: its mean tells no up", "give --attitude constant:0,0")
    up_world = unit(mean)
    ups = [unit(rotations[place].T @ up_world) for place in places]
    forward = rotations[places][:, :, 2]
    yaws: list[float | None] = [float(angle) for angle in np.arctan2(forward[:, 0], forward[:, 2])]
    return ups, yaws, NOTE


def _poses_of(folder: Path) -> Path:
    home = folder.resolve()
    name = f"{home.name}.txt"
    places = [folder / "poses.txt", folder / name, home.parent / "poses" / name]
    places.append(home.parent.parent / "poses" / name)
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise InputError(folder, f"has no poses/{name}", "copy it, or give --attitude constant:0,0")
    return found


def _camera_of(folder: Path) -> str:
    return next((number for number in CAMERAS if images_in(folder / f"image_{number}")), "")
