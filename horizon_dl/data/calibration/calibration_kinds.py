"""Calibration files of other programs: Kalibr, ROS, OpenCV, EuRoC."""

import numpy as np

from horizon_dl.data.calibration.calibration import Calibration, Fields, build_camera
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rpy_from_rotation
from horizon_dl.geometry.camera import Camera, CameraModel

# Every name under which a program writes a model that is supported.
DISTORTION_MODELS: dict[str, CameraModel] = {
    "radtan": "radtan",
    "radial-tangential": "radtan",
    "plumb_bob": "radtan",
    "rational_polynomial": "radtan",  # taken if its further coefficients are zero
    "equidistant": "kannala_brandt",
    "fisheye": "kannala_brandt",
    "kannala_brandt": "kannala_brandt",
    "none": "pinhole",
    "": "pinhole",
}
OPENCV_MATRIX_NAMES = ("camera_matrix", "Camera_Matrix", "cameraMatrix", "K")
OPENCV_DISTORTION_NAMES = (
    "distortion_coefficients",
    "Distortion_Coefficients",
    "distCoeffs",
    "dist_coeffs",
    "D",
)


def kalibr(fields: Fields) -> Calibration:
    """Kalibr's camchain: its first camera; `T_cam_imu`, if there, is the mount (IMU axes taken as FRD)."""
    name = "cam0" if isinstance(fields.content.get("cam0"), dict) else "cam1"
    inner = Fields(fields.path, fields.get(name))
    camera = _resolution_camera(inner, "distortion_coeffs")
    if "T_cam_imu" not in inner.content:
        return Calibration(camera)
    rows = inner.get("T_cam_imu")
    try:
        matrix = np.array(rows, dtype=np.float64).reshape(4, 4)[:3, :3]
    except (TypeError, ValueError):
        raise inner.wrong("T_cam_imu", "four rows of four numbers") from None
    _check_rotation(inner, "T_cam_imu", matrix)
    return Calibration(camera, 0, rpy_from_rotation((OPTICAL_FROM_FRD.T @ matrix).T))


def euroc_sensor(fields: Fields) -> Calibration:
    """EuRoC's sensor.yaml; its mount is `body_from_camera`, as its body's axes are no FRD."""
    return Calibration(_resolution_camera(fields, "distortion_coefficients"))


def body_from_camera(fields: Fields) -> np.ndarray:
    """Rotation (3, 3) camera optical to body of EuRoC's `T_BS`."""
    matrix = np.array(fields.numbers("T_BS", 16)).reshape(4, 4)[:3, :3]
    _check_rotation(fields, "T_BS", matrix)
    return matrix


def ros_camera_info(fields: Fields) -> Calibration:
    """ROS camera_info as camera_calibration writes it."""
    return Calibration(_matrix_camera(fields, str(fields.get("distortion_model"))))


def opencv(fields: Fields) -> Calibration:
    """OpenCV's FileStorage YAML; four coefficients with a fisheye flag are Kannala-Brandt."""
    fisheye = bool(fields.content.get("fisheye_model") or fields.content.get("fisheye"))
    return Calibration(_matrix_camera(fields, "fisheye" if fisheye else "radtan"))


def _resolution_camera(fields: Fields, distortion_name: str) -> Camera:
    """Camera of Kalibr and EuRoC: resolution, intrinsics, distortion model."""
    if fields.get("camera_model") != "pinhole":
        raise fields.wrong(
            "camera_model", "a calibration with the pinhole projection (radtan or equidistant)"
        )
    model = _model(fields, "distortion_model", str(fields.content.get("distortion_model") or "none"))
    width, height = fields.numbers("resolution", 2)
    sized = Fields(fields.path, {"width": width, "height": height})
    distortion = () if model == "pinhole" else fields.numbers(distortion_name)
    intrinsics = fields.numbers("intrinsics", 4)
    return build_camera(fields, model, (sized.size("width"), sized.size("height")), intrinsics, distortion)


def _matrix_camera(fields: Fields, distortion_model: str) -> Camera:
    """Camera of ROS and OpenCV: a 3x3 matrix and a list of coefficients."""
    model = _model(fields, "distortion_model", distortion_model)
    matrix = fields.numbers(_first(fields, OPENCV_MATRIX_NAMES), 9)
    width = fields.size(_first(fields, ("image_width", "image_Width", "width")))
    height = fields.size(_first(fields, ("image_height", "image_Height", "height")))
    distortion = () if model == "pinhole" else fields.numbers(_first(fields, OPENCV_DISTORTION_NAMES))
    intrinsics = (matrix[0], matrix[4], matrix[2], matrix[5])
    return build_camera(fields, model, (width, height), intrinsics, distortion)


def _model(fields: Fields, name: str, value: str) -> CameraModel:
    if value.lower() not in DISTORTION_MODELS:
        raise fields.wrong(name, "one of " + ", ".join(key for key in DISTORTION_MODELS if key))
    return DISTORTION_MODELS[value.lower()]


def _first(fields: Fields, names: tuple[str, ...]) -> str:
    """The name under which the field is there, else the first, whose absence is then reported."""
    return next((name for name in names if fields.content.get(name) is not None), names[0])


def _check_rotation(fields: Fields, name: str, matrix: np.ndarray) -> None:
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-3) or np.linalg.det(matrix) < 0:
        raise InputError(fields.path, f"field '{name}' is no rotation", "give a 4x4 rigid transform")
