"""A camera as Kalibr and EuRoC write it: camera model, distortion model, intrinsics, resolution."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.fields import Fields
from horizon_dl.calibration.lens_names import WAY_OUT, build_camera, lens_named
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import are_rotations
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.lenses.registry import LENSES

_BEFORE = {"pinhole": 0, "omni": 1, "double_sphere": 2, "eucm": 2}
"""Parameters of the lens that stand before the focal lengths."""


def rig_camera(fields: Fields, distortion_field: str) -> Camera:
    """The camera of a section.

    Raises:
        InputError: a field is missing or wrong, or the model is not known.
    """
    projection = lens_named(fields, "camera_model", str(fields.get("camera_model")))
    stated = fields.text("distortion_model") or "none"
    bend = lens_named(fields, "distortion_model", stated)
    numbers = fields.numbers("intrinsics")
    before = _BEFORE.get(projection)
    if before is None or len(numbers) != before + 4:
        lens_takes = "".join(f"{name}, " for name in list(LENSES[projection].parameters)[: before or 0])
        raise fields.wrong("intrinsics", f"what {projection} takes: {lens_takes}fu, fv, pu, pv")
    values = () if bend == "pinhole" else fields.numbers(distortion_field)
    if projection == "pinhole":
        lens = bend
    elif (projection == "omni" and bend == "radtan") or bend == "pinhole":
        lens, values = projection, (*numbers[:before], *values)
    else:
        problem = f"has the projection {projection} with the distortion {stated}"
        raise InputError(fields.path, problem, WAY_OUT)
    return build_camera(fields, lens, fields.sizes("resolution"), numbers[before:], values)


TRANSFORMS = {"T_cam_imu": True, "T_imu_cam": False, "T_BS": False}
"""Fields that join camera and IMU, and whether they lead from the IMU to the camera."""


def imu_from_camera(fields: Fields) -> tuple[NDArray[np.float64], str] | None:
    """The rotation (3, 3) from the optical frame to the IMU's axes, and the field that states it.

    Raises:
        InputError: it is no rotation.
    """
    for name, to_camera in TRANSFORMS.items():
        if fields.has(name):
            rotation = rotation_of(fields, name)
            return rotation.T if to_camera else rotation, f"{fields.prefix}{name}"
    return None


def rotation_of(fields: Fields, name: str) -> NDArray[np.float64]:
    """The rotation (3, 3) in a 3x3 or 4x4 matrix.

    Raises:
        InputError: missing, of another size, or no rotation.
    """
    numbers = fields.numbers(name)
    if len(numbers) not in (9, 12, 16):
        raise fields.wrong(name, "four rows of four numbers")
    matrix = np.array(numbers).reshape(3 if len(numbers) < 16 else 4, -1)[:3, :3]
    if not are_rotations(matrix):
        raise InputError(
            fields.path, f"field '{fields.prefix}{name}' is no rotation", "give a 4x4 rigid transform"
        )
    return matrix
