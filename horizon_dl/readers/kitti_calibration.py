"""KITTI's calibration files: `calib_cam_to_cam.txt`, `calib_velo_to_cam.txt`, `calib_imu_to_velo.txt`."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.limits import MAX_SIDE_PX
from horizon_dl.data.tables.parsing import read_lines
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import are_rotations
from horizon_dl.geometry.camera import Camera

Floats = NDArray[np.float64]
CALIBRATION = "calib_cam_to_cam.txt"


@dataclass(frozen=True)
class KittiCamera:
    """One of the four cameras.

    Attributes:
        camera: its intrinsics.
        cam_from_imu: (3, 3) rotation of the IMU's axes (forward, left, up) into its optical frame.
    """

    camera: Camera
    cam_from_imu: Floats


def read_kitti_camera(folder: Path, number: str, size: tuple[int, int] | None) -> KittiCamera:
    """A camera of a recording's date.

    Args:
        folder: holds the calibration files.
        number: `00` to `03`.
        size: width and height of the images: unsynced drives hold them as the camera took them, with the
            lens' distortion; the others hold rectified ones, which are smaller.

    Raises:
        InputError: a file or field is missing or wrong.
    """
    path = folder / CALIBRATION
    fields = read_fields(path)
    cam_from_velo, velo_from_imu = (
        rotation(folder / name, read_fields(folder / name), "R")
        for name in ("calib_velo_to_cam.txt", "calib_imu_to_velo.txt")
    )
    cam0_from_imu = cam_from_velo @ velo_from_imu
    if (
        size is not None
        and f"S_{number}" in fields
        and size == _size(path, fields, f"S_{number}") != _size(path, fields, f"S_rect_{number}")
    ):
        matrix = numbers(path, fields, f"K_{number}", 9).reshape(3, 3)
        lens = numbers(path, fields, f"D_{number}", 5)
        turn = rotation(path, fields, f"R_{number}")  # camera 0 to this camera, neither rectified
        return KittiCamera(_camera(path, size, matrix, tuple(lens.tolist())), turn @ cam0_from_imu)
    projection = numbers(path, fields, f"P_rect_{number}", 12).reshape(3, 4)
    camera = _camera(path, _size(path, fields, f"S_rect_{number}"), projection[:, :3])
    # All rectified cameras share the axes of rectified camera 0; P_rect only shifts the origin.
    return KittiCamera(camera, rotation(path, fields, "R_rect_00") @ cam0_from_imu)


def projection_camera(path: Path, projection: Floats, size: tuple[int, int]) -> Camera:
    """The camera of a rectified projection (3, 4)."""
    return _camera(path, size, projection[:, :3])


def _camera(path: Path, size: tuple[int, int], matrix: Floats, lens: tuple[float, ...] = ()) -> Camera:
    if min(*size, matrix[0, 0], matrix[1, 1]) < 1 or max(size) > MAX_SIDE_PX:
        raise InputError(path, "holds a size or focal length of no camera", "copy the file again")
    intrinsics = (float(matrix[0, 0]), float(matrix[1, 1]), float(matrix[0, 2]), float(matrix[1, 2]))
    return Camera("radtan", *size, *intrinsics, lens) if any(lens) else Camera("pinhole", *size, *intrinsics)


def _size(path: Path, fields: dict[str, str], name: str) -> tuple[int, int]:
    width, height = numbers(path, fields, name, 2)
    return int(width), int(height)


def read_fields(path: Path) -> dict[str, str]:
    """The lines `name: values` of a file."""
    pairs = (line.partition(":") for line in read_lines(path))
    return {name.strip(): value.strip() for name, _, value in pairs}


def numbers(path: Path, fields: dict[str, str], name: str, count: int) -> Floats:
    """The numbers of a field, of which there have to be `count`."""
    if name not in fields:
        raise InputError(path, f"has no field '{name}'", "copy the calibration of the drive's date again")
    try:
        values = [float(cell) for cell in fields[name].split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise InputError(path, f"field '{name}' has no {count} numbers", "copy the file again")
    return np.array(values)


def rotation(path: Path, fields: dict[str, str], name: str) -> Floats:
    """A field that is a rotation matrix (3, 3)."""
    matrix = numbers(path, fields, name, 9).reshape(3, 3)
    if not are_rotations(matrix):
        raise InputError(path, f"field '{name}' is no rotation", "copy the file again")
    return matrix
