"""TartanAir: a trajectory's folder (`P000`) with `image_left`, `pose_left.txt`, `depth_left`; also version 2.

Wang et al., TartanAir: A Dataset to Push the Limits of Visual SLAM, IROS 2020. Poses are those of the camera
with axes forward, right, down, in NED, quaternions x y z w, a line an image.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.calibration.picture_size import size_of
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, RangeUnit, image_recording
from horizon_dl.data.range_files import load_array
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import images_in, read_numbers, relative_name, usable_quaternions
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import up_in_camera, yaw_of
from horizon_dl.geometry.camera import Camera
from horizon_dl.readers.beside import files_beside

Floats = NDArray[np.float64]

NAME = "tartanair"
NEEDS = "image_left and pose_left.txt"
SIDES = ("left", "lcam_front", "right", "rcam_front")
RATE_HZ = 10.0
NOTE = f"TartanAir has no times: {RATE_HZ:g} frames a second are taken"
FOCAL_WIDTHS = 0.5
"""All its cameras see 90 degrees from left to right."""


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return bool(_side(folder))


def read(folder: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens one trajectory.

    Raises:
        InputError: a file is missing, or there are not as many poses as images.
    """
    side = _side(folder)
    if not side:
        raise InputError(folder, "holds no TartanAir trajectory", f"needed: {NEEDS}")
    images, poses_file = images_in(folder / f"image_{side}"), folder / f"pose_{side}.txt"
    poses = read_numbers(poses_file, 7)
    if len(poses) != len(images):
        problem = f"has {len(poses)} poses for {len(images)} images"
        raise InputError(poses_file, problem, "copy the trajectory whole: a line belongs to an image")
    usable = usable_quaternions(poses[:, 3:7])
    calibration = _calibration(folder, images[0], given)
    times, note = _times(folder, len(images))
    names = [relative_name(image, folder) for image in images]
    truths = files_beside(folder, "labels", names)
    frames = []
    for index, image in enumerate(images):
        quaternion, known = poses[index, [6, 3, 4, 5]], bool(usable[index])
        header = FrameHeader(
            names[index],
            times[index],
            up_in_camera(quaternion, calibration.mount_rpy_rad) if known else None,
            yaw_of(quaternion) if known else None,
            as_read=tuple(poses[index, 3:7].tolist()) if known else None,
        )
        depth = folder / f"depth_{side}" / f"{image.stem}_depth.npy"
        frames.append((header, FrameFiles(image, truths[index], depth if depth.is_file() else None)))
    return image_recording(
        folder.resolve().name,
        NAME,
        calibration.camera,
        frames,
        where=poses_file,
        attitude_from=poses_file.name,
        mount_rpy_rad=calibration.mount_rpy_rad,
        range_unit=RangeUnit(along="axis"),
        notes=note,
        reading=reading_with(Convention(order="xyzw"), calibration.mount_rpy_rad),
    )


def _side(folder: Path) -> str:
    present = (s for s in SIDES if (folder / f"pose_{s}.txt").is_file() and images_in(folder / f"image_{s}"))
    return next(present, "")


def _times(folder: Path, count: int) -> tuple[list[float], tuple[str, ...]]:
    """Times (s) from version 2's `imu/cam_time.npy`, else at a fixed rate, and a note then."""
    try:
        times = load_array(folder / "imu" / "cam_time.npy").ravel()
    except FrameError:
        times = np.empty(0)
    if len(times) == count and np.isfinite(times).all():
        return times.tolist(), ()
    return [index / RATE_HZ for index in range(count)], (NOTE,)


def _calibration(folder: Path, image: Path, given: Given) -> Calibration:
    if given.camera is not None or (folder / "camera.yaml").is_file():
        return read_calibration(given.camera or folder / "camera.yaml")
    width, height = size_of(image)
    focal = FOCAL_WIDTHS * width
    return Calibration(Camera("pinhole", width, height, focal, focal, width / 2, height / 2))
