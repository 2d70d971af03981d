"""The names under which programs write the lens models, and a checked camera from their values."""

import re
from collections.abc import Sequence

from horizon_dl.calibration.fields import Fields
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.lenses.registry import LENSES

LENS_OF = {name: name for name in LENSES} | {
    "none": "pinhole",
    "plumb_bob": "radtan",
    "radial_tangential": "radtan",
    "radtan5": "radtan",
    "brown": "radtan",
    "brown_conrady": "radtan",
    "rational_polynomial": "rational",
    "pinhole_radtan8": "rational",
    "equidistant": "kannala_brandt",
    "equi": "kannala_brandt",
    "fisheye": "kannala_brandt",
    "opencv_fisheye": "kannala_brandt",
    "kb": "kannala_brandt",
    "kb4": "kannala_brandt",
    "kannalabrandt": "kannala_brandt",
    "kannalabrandt8": "kannala_brandt",
    "kannala_brandt4": "kannala_brandt",
    "ds": "double_sphere",
    "doublesphere": "double_sphere",
    "mei": "omni",
    "omnidirectional": "omni",
    "atan": "fov",
}
WAY_OUT = "calibrate with one of " + ", ".join(LENSES)


def lens_named(fields: Fields, field: str, name: str) -> str:
    """The lens model of a name as programs write it; InputError, which names it, where it is not known."""
    plain = re.sub(
        r"^(distortion[.]|cv2?[.]|cv::)|[\s-]+", lambda found: "" if found[1] else "_", name.strip().lower()
    )
    lens = LENS_OF.get(plain)
    if lens is None:
        problem = f"field '{fields.prefix}{field}' is '{name[:40]}', a lens model that is not known"
        raise InputError(fields.path, problem, WAY_OUT)
    return lens


def build_camera(
    fields: Fields,
    lens: str,
    size: tuple[int, int],
    intrinsics: Sequence[float],
    values: Sequence[float] = (),
) -> Camera:
    """A checked camera; its lens's values are padded with zeros to the model's length.

    Args:
        fields: where the values came from, for the error.
        lens: name of the lens model.
        size: width, height, pixels.
        intrinsics: fx, fy, cx, cy, pixels.
        values: of the lens, in the model's order; trailing zeros may be left out, or be too many.
    """
    fx, fy, cx, cy = intrinsics
    if min(fx, fy) <= 0:
        raise InputError(fields.path, f"focal lengths are {fx:g} and {fy:g}", "give positive pixels")
    parameters, required = LENSES[lens].parameters, LENSES[lens].required
    names = ", ".join(parameters)
    count = len(parameters)
    if any(values[count:]) or len(values) < required:
        raise InputError(
            fields.path,
            f"has {len(values)} distortion coefficients, {lens} takes {count}{f' ({names})' * bool(names)}",
            "calibrate with a model that has as many" if len(values) > count else "complete them",
        )
    padded = (*values, *[0.0] * count)[:count]
    for (name, (low, high)), value in zip(parameters.items(), padded, strict=True):
        if not low <= value <= high:
            problem = f"{name} of the {lens} lens is {value:g}"
            hint = f"it lies between {low:g} and {high:g}: check the order {names}"
            raise InputError(fields.path, problem, hint)
    return Camera(lens, *size, fx, fy, cx, cy, padded)


def matrix_intrinsics(fields: Fields, name: str) -> tuple[float, float, float, float]:
    """fx, fy, cx, cy of a 3x3 camera matrix.

    Raises:
        InputError: no such matrix, one that was never calibrated, or one that is skewed.
    """
    rows = fields.numbers(name, 9)
    if not rows[2] and not rows[5] and rows[6] > 0 and rows[7] > 0:  # by columns, as Open3D and MATLAB
        rows = tuple(rows[place] for place in (0, 3, 6, 1, 4, 7, 2, 5, 8))
    if not any(rows[:6]):
        raise InputError(
            fields.path,
            f"field '{fields.prefix}{name}' is zero: not calibrated",
            "calibrate the camera first",
        )
    if abs(rows[1]) > 1e-3 * abs(rows[0]) or rows[3] or rows[6] or rows[7] or rows[8] != 1:
        raise fields.wrong(name, "a camera matrix fx 0 cx, 0 fy cy, 0 0 1")
    return rows[0], rows[4], rows[2], rows[5]


def size_of(
    fields: Fields, wanted: tuple[int, int] | None, names: Sequence[tuple[str, str]]
) -> tuple[int, int]:
    """Width and height by any of the pairs of names, else those of the images."""
    for width, height in names:
        if fields.has(width) or fields.has(height):
            return fields.size(width), fields.size(height)
    if wanted is None:
        hint = f"add {names[0][0]} and {names[0][1]}, pixels"
        raise InputError(fields.path, "does not say how large its images are", hint)
    return wanted
