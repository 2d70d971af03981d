"""Camera files as tools spell them: other names of lenses, nested sections, chains, encodings; no silence."""

import math
from pathlib import Path

import numpy as np
import pytest

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.calibration.mount import ImuMount
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera

FISHEYE = (-0.00927, 0.04619, -0.0434, 0.00802)
T265 = Camera("kannala_brandt", 212, 200, 71.54, 71.5, 105.88, 100.44, FISHEYE)
K = "[71.54, 0.0, 105.88, 0.0, 71.5, 100.44, 0.0, 0.0, 1.0]"
INFO = f"height: 200\nwidth: 212\ndistortion_model: equidistant\nD: {list(FISHEYE)}\nK: {K}\n"
OWN = (
    "model: kannala_brandt\nwidth: 212\nheight: 200\nfx: 71.54\nfy: 71.5\ncx: 105.88\ncy: 100.44\n"
    f"distortion: {list(FISHEYE)}\n"
)
RIG = (
    "  camera_model: pinhole\n  intrinsics: [71.54, 71.5, 105.88, 100.44]\n  distortion_model: equidistant\n"
    f"  distortion_coeffs: {list(FISHEYE)}\n  resolution: [212, 200]\n"
)
FROM_FLU = "[[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]]"
TO_FLU = "[[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]]"
OPENCV = (
    f"%YAML:1.0\n---\nimage_width: 212\nimage_height: 200\ncamera_matrix: {K}\n"
    "distortion_coefficients: [-0.1, 0.02, 0.001, -0.002]\n"
)


def write(folder: Path, text: str | bytes, name: str = "camera.yaml") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def indented(text: str) -> str:
    return "".join(f"  {line}\n" for line in text.splitlines())


@pytest.mark.parametrize(
    "name",
    [
        *("equidistant", "Equidistant", "EQUIDISTANT", "'fisheye'", "opencv_fisheye", "cv2.fisheye"),
        *("cv::fisheye", "Kannala-Brandt", "kannala brandt", "KannalaBrandt8", "KB", "kb4"),
    ],
)
def test_names_of_the_fisheye(tmp_path: Path, name: str) -> None:
    assert read_calibration(write(tmp_path, INFO.replace("equidistant", name))).camera == T265
    assert read_calibration(write(tmp_path, OWN.replace("kannala_brandt", name))).camera == T265


@pytest.mark.parametrize(
    "name", ["plumb-bob", "Plumb Bob", "radial_tangential", "radial-tangential", "distortion.brown_conrady"]
)
def test_names_of_brown(tmp_path: Path, name: str) -> None:
    text = INFO.replace("equidistant", name).replace(str(list(FISHEYE)), "[0.1, 0.2, 0, 0, 0.3]")
    camera = read_calibration(write(tmp_path, text)).camera
    assert (camera.model, camera.distortion) == ("radtan", (0.1, 0.2, 0.0, 0.0, 0.3))


@pytest.mark.parametrize("name", ["thin_prism_fisheye", "inverse_brown_conrady", "ftheta", "division"])
def test_lenses_that_are_not_known_are_refused_by_name(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=f"'{name}', a lens model that is not known"):
        read_calibration(write(tmp_path, INFO.replace("equidistant", name)))


@pytest.mark.parametrize(
    "text",
    [
        INFO.replace("\n", "\r\n"),
        "---\n" + INFO + "---\n" + INFO,
        ("\ufeff" + INFO).encode(),
        INFO.encode("utf-16"),
        INFO.encode("utf-16-le"),
        INFO.encode("utf-16-be"),
        ("# Gerät\n" + INFO).encode("cp1252"),
        "camera_info:\n" + indented(INFO),
        "/camera:\n  ros__parameters:\n" + indented(indented(INFO)),
    ],
)
def test_how_a_file_is_wrapped_and_encoded(tmp_path: Path, text: str | bytes) -> None:
    assert read_calibration(write(tmp_path, text)).camera == T265


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1"])
def test_encodings_of_xml(tmp_path: Path, encoding: str) -> None:
    text = (
        f'<?xml version="1.0" encoding="{encoding}"?>\n<opencv_storage><image_width>212</image_width>'
        f"<image_height>200</image_height><fisheye_model>1</fisheye_model><camera_matrix><data>\n"
        f"{K.strip('[]').replace(',', '')}</data></camera_matrix><distortion_coefficients><data>\n"
        f"{' '.join(map(str, FISHEYE))}</data></distortion_coefficients></opencv_storage>"
    )
    assert read_calibration(write(tmp_path, text.encode(encoding), "camera.xml")).camera == T265


@pytest.mark.parametrize("name", ["camera0", "left", "front_camera"])
def test_a_rig_under_other_names(tmp_path: Path, name: str) -> None:
    two = f"{name}:\n{RIG}other:\n{RIG.replace('[212, 200]', '[640, 480]')}"
    assert read_calibration(write(tmp_path, f"{name}:\n{RIG}")).camera == T265
    found = read_calibration(write(tmp_path, two), size=(212, 200))
    assert found.camera == T265
    assert name in found.notes[0]
    assert read_calibration(write(tmp_path, two), name="other").camera.width == 640


def test_several_messages_in_a_file_are_chosen_by_size_or_name(tmp_path: Path) -> None:
    large = INFO.replace("200", "400").replace("212", "424")
    path = write(tmp_path, f"left:\n{indented(INFO)}right:\n{indented(large)}")
    assert read_calibration(path, size=(424, 400)).camera.width == 424
    assert read_calibration(path, name="left").camera == T265
    with pytest.raises(InputError, match="2 cameras that fit: left"):
        read_calibration(path)


@pytest.mark.parametrize(("field", "matrix"), [("T_cam_imu", FROM_FLU), ("T_imu_cam", TO_FLU)])
def test_both_ways_of_a_chain_to_the_imu(tmp_path: Path, field: str, matrix: str) -> None:
    path = write(tmp_path, f"cam0:\n{RIG}  {field}: {matrix}\n")
    assert isinstance(read_calibration(path).mount, ImuMount)
    np.testing.assert_allclose(read_calibration(path, imu_axes="flu").mount_rpy_rad, 0.0, atol=1e-9)


def test_a_camera_that_leads_to_the_imu_by_the_one_before(tmp_path: Path) -> None:
    # The optical axes of cam1 are cam0's after a quarter turn to the right about the optical axis.
    turn = "[[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
    second = RIG.replace("[212, 200]", "[200, 212]")
    path = write(tmp_path, f"cam0:\n{RIG}  T_cam_imu: {FROM_FLU}\ncam1:\n{second}  T_cn_cnm1: {turn}\n")
    roll, pitch, yaw = np.degrees(read_calibration(path, name="cam1", imu_axes="flu").mount_rpy_rad)
    assert abs(roll) == pytest.approx(90.0)
    assert (pitch, yaw) == pytest.approx((0.0, 0.0), abs=1e-9)
    alone = write(tmp_path, f"cam0:\n{RIG}cam1:\n{second}  T_cn_cnm1: {turn}\n")
    assert read_calibration(alone, name="cam1").mount_rpy_rad == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("mirror", ["xi: 1.2\n", "xi: [1.2]\n", "xi: {rows: 1, cols: 1, data: [1.2]}\n"])
def test_opencvs_omnidirectional_camera(tmp_path: Path, mirror: str) -> None:
    camera = read_calibration(write(tmp_path, OPENCV + mirror)).camera
    assert (camera.model, camera.distortion) == ("omni", (1.2, -0.1, 0.02, 0.001, -0.002))


def test_a_matrix_by_columns(tmp_path: Path) -> None:
    by_columns = "[71.54, 0, 0, 0, 71.5, 0, 105.88, 100.44, 1]"
    assert read_calibration(write(tmp_path, INFO.replace(K, by_columns))).camera == T265


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (OWN + "mount_rpy_rad: [0, -0.2, 0]\n", "a field 'mount_rpy_rad', which is not known"),
        (INFO + "mount: [0, -9, 0]\n", "a field 'mount', which is not known"),
        (OWN + "rotate_images: 90cw\n", "a field 'rotate_images', which is not known"),
        (OWN + "k1: -0.1\n", "a field 'k1', which is not known"),
        (OWN + "distortion_coeffs: [-0.1, 0, 0, 0]\n", "a field 'distortion_coeffs', which is not known"),
        (OWN + "fx: 80\n", "'fx' stands twice"),
        ("[image]\n\nwidth\n212\n\n[narrow_stereo]\n\ncamera matrix\n", "ost.txt, which does not name"),
    ],
)
def test_what_would_be_left_out_in_silence_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_calibration(write(tmp_path, text))


def test_a_users_own_notes_do_no_harm(tmp_path: Path) -> None:
    text = OWN + "comment: front camera\nserial: 12\ncamera_name: left\nmount_rpy_deg: [0, -9, 0]\n"
    found = read_calibration(write(tmp_path, text))
    assert found.camera == T265
    assert found.mount_rpy_rad[1] == pytest.approx(math.radians(-9))
