"""Calibration files of every kind, written by hand and by OpenCV itself."""

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera

OWN = """# a comment
model: radtan
width: 520
height: 240
fx: 323.93
fy: 323.97
cx: 262.3
cy: 213.96
distortion: [-0.33786, 0.13481, -0.00011, 0.00044, -0.02786]
rotate_image: 90ccw
mount_rpy_deg: [0.0, -16.7, 0.0]
"""
KALIBR = """cam0:
  camera_model: pinhole
  distortion_model: equidistant
  distortion_coeffs: [0.01, -0.002, 0.003, -0.0004]
  intrinsics: [190.9, 190.8, 254.9, 256.8]
  resolution: [512, 500]
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.1]
  - [0.0, 0.0, 1.0, 0.2]
  - [1.0, 0.0, 0.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  timeshift_cam_imu: 0.01
"""
ROS = """image_width: 640
image_height: 480
camera_name: head
camera_matrix: {rows: 3, cols: 3, data: [430.2, 0, 306.7, 0, 430.5, 227.2, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.33, 0.11, 0.001, -0.002, 0]}
"""
EUROC = """%YAML:1.0
# General sensor definitions.
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "camera.yaml"
    path.write_text(text)
    return path


def test_own_file(tmp_path: Path) -> None:
    calibration = read_calibration(write(tmp_path, OWN))
    lens = (-0.33786, 0.13481, -0.00011, 0.00044, -0.02786)
    assert calibration.camera == Camera("radtan", 520, 240, 323.93, 323.97, 262.3, 213.96, lens)
    assert calibration.rotate_quarter_turns_ccw == 1
    assert calibration.mount_rpy_rad == pytest.approx((0.0, math.radians(-16.7), 0.0))
    assert read_calibration(tmp_path / "camera.yaml") == calibration


def test_pinhole_needs_neither_distortion_nor_mount(tmp_path: Path) -> None:
    text = "model: pinhole\nwidth: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 31.5\ncy: 23.5\n"
    calibration = read_calibration(write(tmp_path, text))
    assert calibration.camera == Camera("pinhole", 64, 48, 50.0, 50.0, 31.5, 23.5)
    assert calibration.mount_rpy_rad == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("word", "turns"), [("90ccw", 1), ("180", 2), ("90cw", 3), ("none", 0), ("0", 0), ("270ccw", 3)]
)
def test_rotation_words(tmp_path: Path, word: str, turns: int) -> None:
    path = write(tmp_path, OWN.replace("90ccw", word))
    assert read_calibration(path).rotate_quarter_turns_ccw == turns


def test_kalibr(tmp_path: Path) -> None:
    calibration = read_calibration(write(tmp_path, KALIBR + "imu_axes: frd\n"))
    lens = (0.01, -0.002, 0.003, -0.0004)
    assert calibration.camera == Camera("kannala_brandt", 512, 500, 190.9, 190.8, 254.9, 256.8, lens)
    # An IMU with x forward, y right, z down and a camera along x: no mount rotation.
    assert calibration.mount_rpy_rad == pytest.approx((0.0, 0.0, 0.0))


def test_kalibr_mount_looking_down(tmp_path: Path) -> None:
    c, s = math.cos(0.3), math.sin(0.3)
    # Optical axis: forward and, by 0.3 rad, down in the IMU's FRD axes.
    rows = [[0, 1, 0, 0], [-s, 0, c, 0], [c, 0, s, 0], [0, 0, 0, 1]]
    head, _, _ = KALIBR.partition("  T_cam_imu:")
    calibration = read_calibration(write(tmp_path, f"{head}  T_cam_imu: {rows}\nimu_axes: frd\n"))
    assert calibration.mount_rpy_rad == pytest.approx((0.0, -0.3, 0.0))


def test_ros_camera_info(tmp_path: Path) -> None:
    camera = read_calibration(write(tmp_path, ROS)).camera
    assert camera == Camera("radtan", 640, 480, 430.2, 430.5, 306.7, 227.2, (-0.33, 0.11, 0.001, -0.002, 0.0))


def test_euroc_sensor(tmp_path: Path) -> None:
    camera = read_calibration(write(tmp_path, EUROC)).camera
    assert (camera.model, camera.width, camera.fx, camera.cy) == ("radtan", 752, 458.654, 248.375)
    assert camera.distortion == (-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0)


def test_file_that_opencv_wrote(tmp_path: Path) -> None:
    path = tmp_path / "opencv.yml"
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 320)
    storage.write("image_height", 240)
    storage.write("camera_matrix", np.array([[200.0, 0, 160.5], [0, 201.0, 119.5], [0, 0, 1]]))
    storage.write("distortion_coefficients", np.array([[-0.1, 0.02, 0.001, 0.002, 0.003]]))
    storage.release()
    camera = read_calibration(path).camera
    assert camera == Camera("radtan", 320, 240, 200.0, 201.0, 160.5, 119.5, (-0.1, 0.02, 0.001, 0.002, 0.003))


@pytest.mark.parametrize("field", ["model", "width", "height", "fx", "fy", "cx", "cy", "distortion"])
def test_missing_field_is_named(tmp_path: Path, field: str) -> None:
    text = "\n".join(line for line in OWN.splitlines() if not line.startswith(f"{field}:"))
    with pytest.raises(InputError, match=f"camera.yaml: has no field '{field}'"):
        read_calibration(write(tmp_path, text))


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("fx: 323.93", "fx: wide", "field 'fx' is 'wide'"),
        ("fx: 323.93", "fx: .nan", "field 'fx' is 'nan'"),
        ("fx: 323.93", "fx: -1", "focal lengths are -1"),
        ("width: 520", "width: 0", "field 'width'"),
        ("width: 520", "width: 520.5", "field 'width'"),
        ("model: radtan", "model: thin_prism", "one of pinhole, radtan, rational, kannala_brandt"),
        ("rotate_image: 90ccw", "rotate_image: 45", "field 'rotate_image'"),
        ("[0.0, -16.7, 0.0]", "[0.0, -16.7]", "field 'mount_rpy_deg'.*3 numbers"),
        ("-0.02786]", "-0.02786, 0.1]", "6 distortion coefficients, radtan takes 5"),
        ("-0.02786]", "-0.02786", "not valid YAML"),
        ("model: radtan", "model: !!python/object/apply:os.getcwd []", "not valid YAML"),
    ],
)
def test_wrong_values_are_named(tmp_path: Path, before: str, after: str, message: str) -> None:
    assert before in OWN
    with pytest.raises(InputError, match=message) as caught:
        read_calibration(write(tmp_path, OWN.replace(before, after)))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "just words", "- 1\n- 2\n", "\x00\x01"])
def test_what_is_no_mapping_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match=r"camera\.yaml: "):
        read_calibration(write(tmp_path, text))


@pytest.mark.parametrize("name", ["0", "1.5", "2024-01-01", "~", "true"])
@pytest.mark.parametrize("around", ["", "camera:\n  ", "a:\n  b:\n    "])
def test_names_that_yaml_does_not_take_for_text(tmp_path: Path, around: str, name: str) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text(f"{around}{name}: {{model: pinhole}}\n")
    with pytest.raises(InputError):
        read_calibration(path)


def test_deeply_nested_json_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    for depth in (50, 300, 600, 900, 2000, 100_000):
        path.write_text('{"a":' * depth + "1" + "}" * depth)
        with pytest.raises(InputError):
            read_calibration(path)


def test_missing_and_binary_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is missing"):
        read_calibration(tmp_path / "none.yaml")
    path = tmp_path / "binary.yaml"
    path.write_bytes(b"\x89\xff\x00\x80")
    with pytest.raises(InputError, match="cannot be read"):
        read_calibration(path)


def test_kalibr_with_a_matrix_that_is_no_rotation(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no rotation"):
        read_calibration(write(tmp_path, KALIBR.replace("- [1.0, 0.0, 0.0, 0.3]", "- [2.0, 0.0, 0.0, 0.3]")))
    with pytest.raises(InputError, match="camera_model"):
        read_calibration(write(tmp_path, KALIBR.replace("camera_model: pinhole", "camera_model: spherical")))
