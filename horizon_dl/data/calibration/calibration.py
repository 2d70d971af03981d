"""Calibration files: the project's camera.yaml, and one door for the kinds that people have."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from horizon_dl.data.regular_file import read_regular
from horizon_dl.data.safe_yaml import MOST_BYTES, BoundedLoader, brief, parse_yaml
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera, CameraModel

QUARTER_TURNS_CCW = {"none": 0, "0": 0, "90ccw": 1, "90cw": 3, "180": 2, "270ccw": 3, "270cw": 1}
MODELS: dict[str, CameraModel] = {
    "pinhole": "pinhole",
    "radtan": "radtan",
    "kannala_brandt": "kannala_brandt",
}
LENGTHS = {"pinhole": 0, "radtan": 5, "kannala_brandt": 4}
MAX_SIDE_PX = 20000


@dataclass(frozen=True)
class Calibration:
    """A camera and how it sits in the body.

    Attributes:
        camera: intrinsics of the upright image.
        rotate_quarter_turns_ccw: how the stored image is turned to be upright.
        mount_rpy_rad: roll, pitch, yaw (rad) of the camera in the body (FRD).
    """

    camera: Camera
    rotate_quarter_turns_ccw: int = 0
    mount_rpy_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)


class _Loader(BoundedLoader):
    """The bounded loader, which reads OpenCV's matrices as plain mappings."""


def _opencv_matrix(loader: yaml.SafeLoader, node: yaml.Node) -> Any:
    if not isinstance(node, yaml.MappingNode):
        raise yaml.constructor.ConstructorError(None, None, "an opencv-matrix is a mapping", node.start_mark)
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", _opencv_matrix)


def load_yaml(path: Path) -> dict[str, Any]:
    """The mapping in a YAML file, OpenCV's dialect (`%YAML:1.0`, `!!opencv-matrix`) included.

    Raises:
        InputError: missing, not YAML, or not a mapping.
    """
    try:
        text = read_regular(path, MOST_BYTES)
    except FileNotFoundError:
        raise InputError(
            path, "is missing", "add the camera's calibration, see README, data formats"
        ) from None
    try:
        content = parse_yaml(re.sub(r"\A%YAML:1\.\d[^\n]*\n", "", text), _Loader)
    except ValueError as error:
        raise InputError(path, str(error), "correct the file") from None
    if not isinstance(content, dict):
        raise InputError(path, "holds no fields", "write it as 'name: value' lines")
    return content


@dataclass(frozen=True)
class Fields:
    """Typed access to a file's fields, with an error that names file and field."""

    path: Path
    content: Mapping[str, Any]

    def get(self, name: str) -> Any:
        """The field's value; InputError where it is missing."""
        if self.content.get(name) is None:
            raise InputError(self.path, f"has no field '{name}'", "add it, see README, data formats")
        return self.content[name]

    def wrong(self, name: str, need: str) -> InputError:
        """The error for a field with an unusable value."""
        return InputError(self.path, f"field '{name}' is {brief(self.content.get(name))}", f"give {need}")

    def number(self, name: str) -> float:
        """A finite number."""
        return self._numbers(name, [self.get(name)], "a number")[0]

    def size(self, name: str) -> int:
        """A positive whole number of pixels."""
        value = self.number(name)
        if value != int(value) or not 1 <= value <= MAX_SIDE_PX:
            raise self.wrong(name, f"whole pixels from 1 to {MAX_SIDE_PX}")
        return int(value)

    def numbers(self, name: str, count: int | None = None) -> tuple[float, ...]:
        """A list of finite numbers, of `count` if given."""
        value = self.get(name)
        if isinstance(value, Mapping):  # OpenCV, ROS: rows, cols, data
            value = Fields(self.path, value).get("data")
        need = "a list of numbers" if count is None else f"{count} numbers"
        if not isinstance(value, Sequence) or isinstance(value, str) or count not in (None, len(value)):
            raise self.wrong(name, need)
        return self._numbers(name, value, need)

    def _numbers(self, name: str, values: Sequence[Any], need: str) -> tuple[float, ...]:
        try:
            numbers = tuple(float(v) for v in values)
        except (TypeError, ValueError, OverflowError):
            raise self.wrong(name, need) from None
        if not all(map(math.isfinite, numbers)):
            raise self.wrong(name, f"{need}, all finite")
        return numbers


def build_camera(
    fields: Fields,
    model: CameraModel,
    size: tuple[int, int],
    intrinsics: Sequence[float],
    distortion: Sequence[float],
) -> Camera:
    """A checked camera; distortion is padded with zeros to the model's length.

    Args:
        fields: where the values came from, for the error.
        model: the lens model.
        size: width, height, pixels.
        intrinsics: fx, fy, cx, cy, pixels.
        distortion: in the model's order; trailing zeros may be left out, or be too many.
    """
    fx, fy, cx, cy = intrinsics
    if min(fx, fy) <= 0:
        raise InputError(fields.path, f"focal lengths are {fx:g} and {fy:g}", "give positive pixels")
    length = LENGTHS[model]
    if any(distortion[length:]):
        raise InputError(
            fields.path,
            f"has {len(distortion)} distortion coefficients, {model} takes {length}",
            "calibrate with radtan (k1, k2, p1, p2, k3) or kannala_brandt (k1 to k4)",
        )
    padded = (*distortion, *[0.0] * length)[:length]
    return Camera(model, *size, fx, fy, cx, cy, padded)


def read_camera_yaml(path: Path) -> Calibration:
    """The project's own camera.yaml.

    Fields: `model` (pinhole, radtan, kannala_brandt), `width`, `height`, `fx`, `fy`, `cx`, `cy` (pixels, of
    the upright image), `distortion` (k1, k2, p1, p2, k3; fisheye k1 to k4; may be left out for pinhole), and
    if they differ from zero `rotate_image` (90ccw, 90cw, 180: how the stored image is turned) and
    `mount_rpy_deg`.

    Raises:
        InputError: a field is missing or wrong; the error names it.
    """
    fields = Fields(path, load_yaml(path))
    name = brief(fields.get("model")).strip("'")
    if name not in MODELS:
        raise fields.wrong("model", "one of " + ", ".join(MODELS))
    model = MODELS[name]
    has_lens = model != "pinhole" or bool(fields.content.get("distortion"))
    camera = build_camera(
        fields,
        model,
        (fields.size("width"), fields.size("height")),
        [fields.number(key) for key in ("fx", "fy", "cx", "cy")],
        fields.numbers("distortion") if has_lens else (),
    )
    turn = brief(fields.content.get("rotate_image", "none") or "none").strip("'").lower()
    if turn not in QUARTER_TURNS_CCW:
        raise fields.wrong("rotate_image", "one of " + ", ".join(QUARTER_TURNS_CCW))
    mount = (0.0, 0.0, 0.0)
    if fields.content.get("mount_rpy_deg") is not None:
        roll, pitch, yaw = fields.numbers("mount_rpy_deg", 3)
        mount = (math.radians(roll), math.radians(pitch), math.radians(yaw))
    return Calibration(camera, QUARTER_TURNS_CCW[turn], mount)


def read_calibration(path: Path) -> Calibration:
    """A calibration file of any known kind: camera.yaml, Kalibr camchain, ROS camera_info, OpenCV, EuRoC.

    Raises:
        InputError: not readable, or a field is missing or wrong.
    """
    from horizon_dl.data.calibration import calibration_kinds as kinds

    fields = Fields(path, load_yaml(path))
    if any(isinstance(fields.content.get(key), dict) for key in ("cam0", "cam1")):
        return kinds.kalibr(fields)
    if "resolution" in fields.content and "camera_model" in fields.content:
        return kinds.euroc_sensor(fields)
    if "image_width" in fields.content and "distortion_model" in fields.content:
        return kinds.ros_camera_info(fields)
    if any(key in fields.content for key in (*kinds.OPENCV_MATRIX_NAMES, *kinds.OPENCV_DISTORTION_NAMES)):
        return kinds.opencv(fields)
    return read_camera_yaml(path)
