"""KITTI raw: left colour camera (image_02, rectified), attitude from oxts.

Geiger et al., Vision meets Robotics: The KITTI Dataset, IJRR 2013. DATA is the drive, its date folder, or the
folder that holds the date folder.
"""

import math
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.calibration.calibration import MAX_SIDE_PX
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, RangeUnit, image_recording
from horizon_dl.data.readers.parsing import beside, images_in, read_lines, relative_name, whole_number
from horizon_dl.data.regular_file import read_regular
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import rotation_from_rpy, unit
from horizon_dl.geometry.camera import Camera

Floats = NDArray[np.float64]

NAME = "kitti"
NEEDS = "KITTI raw, <date>/<drive>/image_02/data and oxts, with calib_*.txt in <date>"
CAMERA_HEIGHT_M = 1.65
CALIBRATION = "calib_cam_to_cam.txt"
FRAME_PERIOD_S = 0.1
MOST_OXTS = 4096
"""Bytes of a frame's file: 30 numbers."""
RANGE_UNIT = RangeUnit(1 / 256, "ray")
FRD_FROM_FLU = np.diag([1.0, -1.0, -1.0])


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return bool(drives_below(folder))


def drives_below(folder: Path) -> list[Path]:
    """Drive folders: the folder itself, or those one or two levels below."""
    places = [folder, *folder.glob("*"), *folder.glob("*/*")]
    return sorted(p for p in places if (p / "image_02" / "data").is_dir() and (p / "oxts").is_dir())


def read(folder: Path, _: Given = NOTHING_GIVEN) -> Recording:
    """Opens one drive.

    Raises:
        InputError: no drive or several, a calibration file or field is missing, or no frame has an attitude.
    """
    drives = drives_below(folder)
    if not drives:
        raise InputError(folder, "holds no KITTI drive", f"needed: {NEEDS}")
    if len(drives) > 1:
        names = ", ".join(relative_name(d, folder) for d in drives)
        raise InputError(folder, f"holds {len(drives)} drives: {names}", "give the folder of one of them")
    drive = drives[0]
    images = images_in(drive / "image_02" / "data")
    times = frame_times(drive, images)
    places = (drive, drive.absolute().parent)
    with_calibration = (place for place in places if (place / CALIBRATION).is_file())
    camera, cam_from_imu = calibration(next(with_calibration, places[1]))
    floor_up_cam = unit(cam_from_imu @ [0.0, 0.0, 1.0])
    frames = []
    for image, time_s in zip(images, times, strict=True):
        up_cam, yaw_rad = pose_of_frame(drive / "oxts" / "data" / f"{image.stem}.txt", cam_from_imu)
        name = relative_name(image, folder)
        header = FrameHeader(name, time_s, up_cam, yaw_rad, CAMERA_HEIGHT_M, floor_up_cam)
        truth, ranges = beside(drive, "labels", image.stem), beside(drive, "range", image.stem)
        frames.append((header, FrameFiles(image, truth, ranges)))
    return image_recording(
        drive.resolve().name,
        NAME,
        camera,
        frames,
        where=drive,
        attitude_from="oxts/data",
        range_unit=RANGE_UNIT,
    )


def pose_of_frame(path: Path, cam_from_imu: Floats) -> tuple[Floats | None, float | None]:
    """The world's up in the rectified camera and the yaw from one oxts file; None where it is missing.

    oxts angles are about x forward, y left, z up (dataformat.txt: roll > 0 left side up, pitch > 0 front
    down, yaw > 0 counter-clockwise from east). Turning both the body and the world by half a turn about x
    gives FRD and a world whose z points down; there roll keeps its sign, pitch and yaw change theirs.
    """
    try:
        roll, pitch, yaw = (float(cell) for cell in read_regular(path, MOST_OXTS).split()[3:6])
        down_from_body = rotation_from_rpy(roll, -pitch, -yaw)
    except (OSError, ValueError, InputError):
        return None, None
    return unit(cam_from_imu @ FRD_FROM_FLU @ down_from_body.T @ [0.0, 0.0, -1.0]), -yaw


def calibration(folder: Path) -> tuple[Camera, Floats]:
    """The rectified colour camera and the rotation from the IMU's axes into it."""
    path = folder / CALIBRATION
    intrinsics = _read_calib(path)
    projection = _field(path, intrinsics, "P_rect_02", 12).reshape(3, 4)
    width, height = _field(path, intrinsics, "S_rect_02", 2)
    # All rectified cameras share the axes of rectified camera 0; P_rect_02 only shifts the origin.
    rectify = _rotation(path, intrinsics, "R_rect_00")
    cam_from_velo, velo_from_imu = (
        _rotation(folder / name, _read_calib(folder / name), "R")
        for name in ("calib_velo_to_cam.txt", "calib_imu_to_velo.txt")
    )
    if min(width, height, projection[0, 0], projection[1, 1]) < 1 or max(width, height) > MAX_SIDE_PX:
        raise InputError(path, "S_rect_02 or P_rect_02 is of no camera", "copy the file again")
    camera = Camera(
        "pinhole",
        int(width),
        int(height),
        float(projection[0, 0]),
        float(projection[1, 1]),
        float(projection[0, 2]),
        float(projection[1, 2]),
    )
    return camera, rectify @ cam_from_velo @ velo_from_imu


def frame_times(drive: Path, images: list[Path]) -> list[float]:
    """Seconds since the first time stamp, from the camera's list, else the IMU's, else at 10 Hz."""
    for path in (drive / "image_02" / "timestamps.txt", drive / "oxts" / "timestamps.txt"):
        if not path.is_file():
            continue
        stamps = [parse_time(path, line) for line in read_lines(path)]
        numbers = [whole_number(image.stem) for image in images]
        known = [number for number in numbers if number is not None and number < len(stamps)]
        if stamps and len(known) == len(images):
            return [stamps[number] - stamps[0] for number in known]
    return [FRAME_PERIOD_S * index for index in range(len(images))]


def parse_time(path: Path, line: str) -> float:
    """Seconds (epoch 1970, UTC) of a line like `2011-09-26 14:19:35.668269525`."""
    try:
        whole, _, fraction = line.strip().partition(".")
        moment = datetime.strptime(whole, "%Y-%m-%d %H:%M:%S").replace(tzinfo=UTC)
        return moment.timestamp() + float(f"0.{fraction or 0}")
    except ValueError:
        raise InputError(path, f"holds no time in {line.strip()[:40]!r}", "copy the file again") from None


def _read_calib(path: Path) -> dict[str, str]:
    pairs = (line.partition(":") for line in read_lines(path))
    return {name.strip(): value.strip() for name, _, value in pairs}


def _field(path: Path, fields: dict[str, str], name: str, count: int) -> Floats:
    if name not in fields:
        raise InputError(path, f"has no field '{name}'", "copy the calibration of the drive's date again")
    try:
        values = [float(cell) for cell in fields[name].split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise InputError(path, f"field '{name}' has no {count} numbers", "copy the file again")
    return np.array(values)


def _rotation(path: Path, fields: dict[str, str], name: str) -> Floats:
    matrix = _field(path, fields, name, 9).reshape(3, 3)
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-3):
        raise InputError(path, f"field '{name}' is no rotation", "copy the file again")
    return matrix
