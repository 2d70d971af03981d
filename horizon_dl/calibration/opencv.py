"""OpenCV's FileStorage as YAML, JSON or XML, under the names that its samples and users give."""

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera, lens_named, matrix_intrinsics, size_of
from horizon_dl.errors import InputError

NAME = "OpenCV FileStorage"
MATRIX = (
    "camera_matrix",
    "Camera_Matrix",
    "cameraMatrix",
    "CameraMatrix",
    "CameraMat",  # Autoware
    "K",
    "mtx",
    "intrinsic_matrix",
    "M1",  # OpenCV's stereo sample
    "M2",
)
COEFFICIENTS = (
    "distortion_coefficients",
    "Distortion_Coefficients",
    "distCoeffs",
    "dist_coeffs",
    "dist_coeff",
    "distortion_coeffs",
    "DistCoeff",
    "dist",
    "D",
)
PAIRS = (
    ("image_width", "image_height"),
    ("image_Width", "image_Height"),
    ("imageWidth", "imageHeight"),
    ("width", "height"),
)
SIZES = ("ImageSize", "image_size", "imageSize", "img_size", "size", "resolution", "DIM")
FLAGS = ("fisheye_model", "fisheye", "isFisheye")
MODELS = ("distortion_model", "DistModel", "camera_model", "model")
MIRROR = "xi"
"""What cv2.omnidir has beside matrix and coefficients."""
OF_SECOND = {"M1": "D1", "M2": "D2"}


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return any(name in tree for name in MATRIX)


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """One camera a matrix."""
    names = [name for name in MATRIX if fields.has(name)]
    return [_candidate(fields, name, wanted) for name in names if name in OF_SECOND or name == names[0]]


def _candidate(fields: Fields, matrix: str, wanted: Wanted) -> Candidate:
    return Candidate((matrix,), None, lambda: _found(fields, matrix, wanted))


def _found(fields: Fields, matrix: str, wanted: Wanted) -> Found:
    intrinsics = matrix_intrinsics(fields, matrix)
    name = OF_SECOND.get(matrix) or fields.first(COEFFICIENTS)
    values = fields.numbers(name) if fields.has(name) or matrix not in OF_SECOND else ()
    listed = next((each for each in SIZES if fields.has(each)), None)
    size = fields.sizes(listed) if listed else size_of(fields, wanted.size, PAIRS)
    if fields.has(MIRROR):
        mirror = (
            fields.numbers(MIRROR, 1)
            if isinstance(fields.get(MIRROR), dict | list)
            else (fields.number(MIRROR),)
        )
        return Found(build_camera(fields, "omni", size, intrinsics, (*mirror, *values)))
    return Found(build_camera(fields, _lens(fields, values), size, intrinsics, values))


def _lens(fields: Fields, values: tuple[float, ...]) -> str:
    """The lens by a flag or a name, else by the number of coefficients, which OpenCV's functions fix."""
    model = next((name for name in MODELS if fields.text(name)), None)
    stated = None if model is None else lens_named(fields, model, fields.text(model))
    flag = next((name for name in FLAGS if fields.has(name)), None)
    if flag is not None and stated in (None, "pinhole"):
        word = fields.text(flag).lower()
        stated = "kannala_brandt" if word not in ("0", "0.0", "false", "no", "") else "radtan"
    if not any(values):
        return stated or "pinhole"
    if stated in (None, "pinhole"):
        if len(values) == 4:
            raise InputError(
                fields.path,
                "has 4 distortion coefficients and does not say of which lens",
                "add 'distortion_model: radtan' or, made by cv2.fisheye, 'distortion_model: fisheye'",
            )
        stated = "radtan"
    if stated == "radtan" and len(values) > 5:
        _check_thin_prism(fields, values)
        return "rational"
    return stated


def _check_thin_prism(fields: Fields, values: tuple[float, ...]) -> None:
    if any(values[8:]):
        raise InputError(
            fields.path,
            f"has {len(values)} distortion coefficients: thin prism or tilt, a lens model that is not known",
            "calibrate with at most 8 (CALIB_RATIONAL_MODEL)",
        )
