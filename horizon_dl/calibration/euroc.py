"""EuRoC's sensor.yaml, which TUM-VI writes as well."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.rig_camera import imu_from_camera, rig_camera, rotation_of
from horizon_dl.geometry.camera import Camera

NAME = "EuRoC sensor.yaml"
TRANSFORM = "T_BS"


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return "resolution" in tree and "camera_model" in tree


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera."""
    return [
        Candidate((fields.text("comment") or "camera",), fields.sizes("resolution"), lambda: _found(fields))
    ]


def sensor_camera(fields: Fields) -> Camera:
    """The camera alone."""
    return rig_camera(fields, fields.first(("distortion_coefficients", "distortion_coeffs")))


def body_from_camera(fields: Fields) -> NDArray[np.float64]:
    """Rotation (3, 3) from the optical frame to EuRoC's body, by `T_BS`."""
    return rotation_of(fields, TRANSFORM)


def _found(fields: Fields) -> Found:
    joined = imu_from_camera(fields)
    return Found(sensor_camera(fields)) if joined is None else Found(sensor_camera(fields), *joined)
