"""Camera files as people have them: read right, or refused by name; and what the shared cases must give."""

import json
import math
import os
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.calibration.mount import AxesNotStatedError
from horizon_dl.cli import main
from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import camera_rays, project
from horizon_dl.readers.registry import open_recording

FISHEYE = (-0.00927, 0.04619, -0.0434, 0.00802)
T265 = Camera("kannala_brandt", 212, 200, 71.54, 71.5, 105.88, 100.44, FISHEYE)
SAME_AS_OWN = (
    "kalibr_two_cams",
    "opencv_xml",
    "ros1_echo_equidistant",
    "ros1_echo_equidistant_dash",
    "ros2_echo_equidistant",
    "ros_ost_melodic_camera_model_fisheye",
    "vins_kb",
)


@pytest.fixture(scope="module")
def cases() -> Path:
    folder = Path(os.environ.get("HORIZON_DL_CASES", "")) / "cal"
    if not folder.is_dir():
        pytest.skip("needs HORIZON_DL_CASES")
    return folder


@pytest.mark.real_data
@pytest.mark.parametrize("case", SAME_AS_OWN)
def test_a_case_has_the_rays_of_the_own_format(cases: Path, case: str) -> None:
    own = open_recording(cases / "own").calibrated
    rays = camera_rays(own)
    v, u = np.nonzero(rays.valid)
    assert len(v) == own.width * own.height
    there = project(open_recording(cases / case).calibrated, rays.directions[rays.valid].astype(np.float64))
    np.testing.assert_allclose(there, project(own, rays.directions[rays.valid]), atol=1e-9)
    np.testing.assert_allclose(there, np.stack([u, v], -1), atol=1e-3)


@pytest.mark.real_data
@pytest.mark.parametrize(
    ("case", "lens", "values"),
    [
        ("autoware_cameramat", "radtan", (0.1, -0.2, 0.0, 0.0, 0.0)),
        ("kalibr_ds", "double_sphere", (-0.2, 0.59)),
        ("ros_rational8", "rational", (0.93, 0.166, -2.4e-05, -1.4e-05, 0.0029, 1.33, 0.436, 0.0276)),
    ],
)
def test_a_case_of_another_lens(cases: Path, case: str, lens: str, values: tuple[float, ...]) -> None:
    wanted = Camera(lens, 212, 200, 71.54, 71.5, 105.88, 100.44, values)
    assert open_recording(cases / case).calibrated == wanted


@pytest.mark.real_data
def test_an_imus_axes_are_asked_for(cases: Path) -> None:
    path = cases / "kalibr_imu_flu" / "camera.yaml"
    with pytest.raises(AxesNotStatedError, match=r"'imu_axes: flu' .*upright.*'imu_axes: frd' .*upside down"):
        open_recording(path.parent)
    assert read_calibration(path).camera == T265  # who needs no mount is not asked
    assert np.abs(np.degrees(read_calibration(path, imu_axes="flu").mount_rpy_rad)).max() < 1.0
    assert open_recording(path.parent, given=Given(imu_axes="flu")).length == 6


def write(folder: Path, text: str, name: str = "camera.yaml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def kalibr_camera(model: str, intrinsics: list[float], bend: str = "none", coeffs: str = "[]") -> str:
    return (
        f"  camera_model: {model}\n  intrinsics: {intrinsics}\n  distortion_model: {bend}\n"
        f"  distortion_coeffs: {coeffs}\n  resolution: [640, 480]\n"
    )


@pytest.mark.parametrize(
    ("model", "before", "bend", "coeffs", "lens", "values"),
    [
        ("pinhole", [], "radtan", "[0.1, 0.2, 0.3, 0.4]", "radtan", (0.1, 0.2, 0.3, 0.4, 0.0)),
        ("pinhole", [], "equidistant", "[0.1, 0.2, 0.3, 0.4]", "kannala_brandt", (0.1, 0.2, 0.3, 0.4)),
        ("pinhole", [], "fov", "[0.9]", "fov", (0.9,)),
        ("pinhole", [], "none", "[]", "pinhole", ()),
        ("omni", [1.5], "radtan", "[0.1, 0.2, 0.3, 0.4]", "omni", (1.5, 0.1, 0.2, 0.3, 0.4)),
        ("omni", [1.5], "none", "[]", "omni", (1.5, 0.0, 0.0, 0.0, 0.0)),
        ("ds", [-0.2, 0.6], "none", "[]", "double_sphere", (-0.2, 0.6)),
        ("eucm", [0.6, 1.1], "none", "[]", "eucm", (0.6, 1.1)),
    ],
)
def test_kalibrs_models(
    tmp_path: Path,
    model: str,
    before: list[float],
    bend: str,
    coeffs: str,
    lens: str,
    values: tuple[float, ...],
) -> None:
    text = "cam0:\n" + kalibr_camera(model, [*before, 300.0, 301.0, 320.0, 240.0], bend, coeffs)
    camera = read_calibration(write(tmp_path, text)).camera
    assert camera == Camera(lens, 640, 480, 300.0, 301.0, 320.0, 240.0, values)


@pytest.mark.parametrize(
    ("model", "bend", "message"),
    [
        ("spherical", "none", "'spherical', a lens model that is not known"),
        ("pinhole", "thin_prism", "'thin_prism', a lens model that is not known"),
        ("ds", "equidistant", "projection double_sphere with the distortion equidistant"),
    ],
)
def test_kalibrs_unknown_models_are_named(tmp_path: Path, model: str, bend: str, message: str) -> None:
    before = [0.1, 0.6] if model == "ds" else []
    text = "cam0:\n" + kalibr_camera(model, [*before, 300.0, 301.0, 320.0, 240.0], bend, "[0.1, 0, 0, 0]")
    with pytest.raises(InputError, match=message):
        read_calibration(write(tmp_path, text))


def test_one_of_several_cameras(tmp_path: Path) -> None:
    plain = kalibr_camera("pinhole", [300.0, 301.0, 320.0, 240.0])
    other = plain.replace("300.0", "310.0")
    text = f"cam0:\n{plain}  rostopic: /left/image\ncam1:\n{other}  rostopic: /right/image\n"
    path = write(tmp_path, text)
    with pytest.raises(
        InputError, match=r"2 cameras that fit: cam0 \(/left/image, 640x480\) and cam1"
    ) as caught:
        read_calibration(path, size=(640, 480))
    assert "\n" not in str(caught.value)
    for chosen in (
        read_calibration(path, name="cam1"),
        read_calibration(path, name="/right/image"),
        read_calibration(path.with_name("camera.yaml#cam1")),
        read_calibration(write(tmp_path, text + "use_camera: cam1\n", "named.yaml")),
    ):
        assert chosen.camera.fx == 310.0
        assert "cam1" in chosen.notes[0]
    with pytest.raises(InputError, match="no camera 'cam7', but cam0"):
        read_calibration(path, name="cam7")
    with pytest.raises(InputError, match="no camera for images of 752x480"):
        read_calibration(path, size=(752, 480))
    # What the neighbour's lens is does not matter.
    strange = write(tmp_path, text.replace("pinhole", "spherical", 1), "strange.yaml")
    assert read_calibration(strange, name="cam1").camera.fx == 310.0


def test_a_kalibr_imu_of_any_axes(tmp_path: Path) -> None:
    down = rotation_from_rpy(0.0, -0.3, 0.0)  # body from camera, both FRD
    body_from_optical = down @ OPTICAL_FROM_FRD.T
    flu_from_optical = np.diag([1.0, -1.0, -1.0]) @ body_from_optical
    matrix = np.eye(4)
    matrix[:3, :3] = flu_from_optical.T
    head = (
        "cam0:\n"
        + kalibr_camera("pinhole", [300.0, 301.0, 320.0, 240.0])
        + f"  T_cam_imu: {matrix.tolist()}\n"
    )
    assert read_calibration(write(tmp_path, head + "imu_axes: flu\n")).mount_rpy_rad == pytest.approx(
        (0, -0.3, 0)
    )
    with pytest.raises(AxesNotStatedError, match="looks 17 degrees down"):
        _ = read_calibration(write(tmp_path, head)).mount_rpy_rad
    stated = read_calibration(write(tmp_path, head + "mount_rpy_deg: [0, -10, 0]\n"))
    assert stated.mount_rpy_rad == pytest.approx((0.0, math.radians(-10), 0.0))
    for wrong in ("frl", "fld", "enu", "17"):
        with pytest.raises(InputError, match="imu_axes"):
            read_calibration(write(tmp_path, head + f"imu_axes: {wrong}\n"))


ROS = """height: 200
width: 212
{model}
D: {values}
K: [71.54, 0.0, 105.88, 0.0, 71.5, 100.44, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
binning_x: {binning}
roi: {{x_offset: {offset}, y_offset: 0, height: 0, width: 0, do_rectify: False}}
"""


def ros(model: str, values: list[float], binning: int = 0, offset: int = 0) -> str:
    return ROS.format(model=model, values=values, binning=binning, offset=offset)


@pytest.mark.parametrize(
    ("model", "values", "lens"),
    [
        ("distortion_model: plumb_bob", [0.1, 0.2, 0.0, 0.0, 0.0], "radtan"),
        ("distortion_model: plumb_bob", [], "radtan"),
        ("distortion_model: rational_polynomial", [0.1, 0.2, 0.0, 0.0, 0.0, 0.3, 0.0, 0.1], "rational"),
        ("distortion_model: rational_polynomial", [0.1] * 8 + [0.0] * 6, "rational"),
        ("distortion_model: equidistant", [*FISHEYE, 0.0], "kannala_brandt"),
        ("distortion_model: fisheye", list(FISHEYE), "kannala_brandt"),
        ("camera_model: fisheye", list(FISHEYE), "kannala_brandt"),
        ("camera_model: pinhole\ndistortion_model: plumb_bob", [0.1, 0.2, 0.0, 0.0, 0.0], "radtan"),
        ("distortion_model: ''", [0.0] * 5, "pinhole"),
    ],
)
def test_ros_models(tmp_path: Path, model: str, values: list[float], lens: str) -> None:
    camera = read_calibration(write(tmp_path, ros(model, values) + "---\n" + ros(model, values))).camera
    assert (camera.model, camera.fx, camera.cy) == (lens, 71.54, 100.44)
    assert camera.distortion[: len(values)] == tuple(values[: len(camera.distortion)])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            ros("distortion_model: thin_prism", [0.1, 0.2, 0.0, 0.0]),
            "'thin_prism', a lens model that is not known",
        ),
        (ros("distortion_model: ''", [0.1, 0.2, 0.0, 0.0, 0.0]), "states no lens model"),
        (ros("camera_model: fisheye\ndistortion_model: plumb_bob", [0.1] * 4), "which are two lenses"),
        (ros("distortion_model: plumb_bob", [0.1] * 5, binning=2), "cut out or binned"),
        (ros("distortion_model: plumb_bob", [0.1] * 5, offset=8), "cut out or binned"),
        (
            ros("distortion_model: rational_polynomial", [0.1] * 14),
            "14 distortion coefficients, rational takes 8",
        ),
        (
            ros("distortion_model: plumb_bob", [0.0] * 5).replace("71.54", "0").replace("71.5,", "0,"),
            "focal|calib",
        ),
    ],
)
def test_ros_files_that_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_calibration(write(tmp_path, text))


@pytest.mark.parametrize("suffix", ["yml", "json", "xml"])
@pytest.mark.parametrize(
    ("flag", "count", "lens"), [(0, 5, "radtan"), (0, 8, "rational"), (1, 4, "kannala_brandt")]
)
def test_what_opencv_writes(tmp_path: Path, suffix: str, flag: int, count: int, lens: str) -> None:
    path = tmp_path / f"camera.{suffix}"
    values = np.linspace(0.01, 0.08, count)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("calibration_time", "Thu 26 Nov 2026")
    storage.write("image_width", 320)
    storage.write("image_height", 240)
    storage.write("fisheye_model", flag)
    storage.write("camera_matrix", np.array([[200.0, 0, 160.5], [0, 201.0, 119.5], [0, 0, 1]]))
    storage.write("distortion_coefficients", values.reshape(-1, 1))
    storage.write("extrinsic_parameters", np.zeros((20, 6)))
    storage.release()
    camera = read_calibration(path).camera
    assert (camera.model, camera.fy, camera.cx) == (lens, 201.0, 160.5)
    np.testing.assert_allclose(camera.distortion[:count], values)


def test_opencv_files_without_a_size_or_a_lens(tmp_path: Path) -> None:
    matrix = "mtx: [[200, 0, 160], [0, 200, 120], [0, 0, 1]]\n"
    path = write(tmp_path, matrix + "dist: [[0.1, 0.2, 0.0, 0.0, 0.0]]\n")
    assert read_calibration(path, size=(320, 240)).camera.width == 320
    with pytest.raises(InputError, match="how large its images are"):
        read_calibration(path)
    with pytest.raises(InputError, match="4 distortion coefficients and does not say of which lens"):
        read_calibration(write(tmp_path, matrix + "dist: [0.1, 0.2, 0.0, 0.0]\n"), size=(320, 240))
    with pytest.raises(InputError, match="thin prism"):
        read_calibration(write(tmp_path, matrix + f"dist: {[0.1] * 12}\n"), size=(320, 240))
    stereo = "M1: [200, 0, 160, 0, 200, 120, 0, 0, 1]\nD1: [0.1, 0, 0, 0, 0]\n"
    stereo = write(tmp_path, stereo + stereo.replace("1:", "2:").replace("200", "300"))
    assert read_calibration(stereo, size=(320, 240), name="M2").camera.fx == 300.0
    with pytest.raises(InputError, match="M1 and M2"):
        read_calibration(stereo, size=(320, 240))


VINS = """%YAML:1.0
---
model_type: {model}
camera_name: camera
image_width: 640
image_height: 480
"""


def test_vins(tmp_path: Path) -> None:
    bend = "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4\n"
    pinhole = "projection_parameters: {fx: 300, fy: 301, cx: 320, cy: 240}\n"
    camera = read_calibration(write(tmp_path, VINS.format(model="PINHOLE") + bend + pinhole)).camera
    assert camera == Camera("radtan", 640, 480, 300, 301, 320, 240, (0.1, 0.2, 0.3, 0.4, 0.0))
    mei = (
        "mirror_parameters: {xi: 1.9}\nprojection_parameters: {gamma1: 700, gamma2: 701, u0: 320, v0: 240}\n"
    )
    camera = read_calibration(write(tmp_path, VINS.format(model="MEI") + bend + mei)).camera
    assert camera == Camera("omni", 640, 480, 700, 701, 320, 240, (1.9, 0.1, 0.2, 0.3, 0.4))
    with pytest.raises(InputError, match="'SCARAMUZZA', a lens model that is not known"):
        read_calibration(write(tmp_path, VINS.format(model="SCARAMUZZA") + bend))
    rotation = "extrinsicRotation: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [0,0,1,-1,0,0,0,-1,0]}\n"
    text = VINS.format(model="PINHOLE") + bend + pinhole + rotation
    assert read_calibration(write(tmp_path, text), imu_axes="flu").mount_rpy_rad == pytest.approx((0, 0, 0))


ORB3 = """%YAML:1.0
File.version: "1.0"
Camera.type: "{kind}"
Camera1.fx: 458.654
Camera1.fy: 457.296
Camera1.cx: 367.215
Camera1.cy: 248.375
Camera1.k1: -0.28
Camera1.k2: 0.07
{more}
Camera.width: 752
Camera.height: 480
IMU.T_b_c1: !!opencv-matrix
   rows: 4
   cols: 4
   dt: f
   data: [0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]
"""


def test_orb_slam(tmp_path: Path) -> None:
    text = ORB3.format(kind="PinHole", more="Camera1.p1: 0.0002\nCamera1.p2: 1.8e-05")
    calibration = read_calibration(write(tmp_path, text), imu_axes="flu")
    lens = (-0.28, 0.07, 0.0002, 1.8e-05, 0.0)
    assert calibration.camera == Camera("radtan", 752, 480, 458.654, 457.296, 367.215, 248.375, lens)
    assert calibration.mount_rpy_rad == pytest.approx((0, 0, 0))
    fisheye = read_calibration(
        write(tmp_path, ORB3.format(kind="KannalaBrandt8", more="Camera1.k3: 0.1\nCamera1.k4: 0.2"))
    ).camera
    assert (fisheye.model, fisheye.distortion) == ("kannala_brandt", (-0.28, 0.07, 0.1, 0.2))
    with pytest.raises(InputError, match="'Spherical', a lens model that is not known"):
        read_calibration(write(tmp_path, ORB3.format(kind="Spherical", more="")))
    values = {"fx": 517.3, "fy": 516.5, "cx": 318.6, "cy": 255.3, "k1": 0.26}
    old = "%YAML:1.0\n\n#----\n" + "".join(f"Camera.{name}: {value}\n" for name, value in values.items())
    camera = read_calibration(write(tmp_path, old), size=(640, 480)).camera
    assert camera == Camera("radtan", 640, 480, 517.3, 516.5, 318.6, 255.3, (0.26, 0.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "text",
    [
        '%YAML:1.0\nCamera.type: "PinHole"\nCamera1.fx: \n',
        'Camera.type: "PinHole"\n',
        "cam0:\n",
        '{"value0": {"T_imu_cam": [], "intrinsics": [], "resolution": []}}',
        "# Camera list\n",
        "CameraMat:\n",
        "model_type: PINHOLE\n",
        "camera_matrix:\n",
    ],
)
def test_a_file_of_a_known_kind_without_a_camera(tmp_path: Path, text: str) -> None:
    for name in ("camera.yaml", "camera.json", "cameras.txt"):
        for wanted in ({}, {"name": "cam0"}, {"size": (32, 24)}, {"name": "1", "size": (32, 24)}):
            with pytest.raises(InputError):
                read_calibration(write(tmp_path, text, name), **wanted)


def test_basalt(tmp_path: Path) -> None:
    def one(kind: str, **values: float) -> dict[str, object]:
        return {"camera_type": kind, "intrinsics": {"fx": 300, "fy": 301, "cx": 320, "cy": 240, **values}}

    s = math.sqrt(0.5)
    pose = {"px": 0, "py": 0, "pz": 0, "qx": -0.5, "qy": 0.5, "qz": -0.5, "qw": 0.5}
    content = {
        "value0": {
            "T_imu_cam": [pose] * 4,
            "intrinsics": [
                one("ds", xi=-0.2, alpha=0.6),
                one("kb4", k1=0.1, k2=0.2, k3=0.3, k4=0.4),
                one("ucm", alpha=0.7),
                one("cylinder", s=s),
            ],
            "resolution": [[640, 480]] * 4,
        }
    }
    path = write(tmp_path, json.dumps(content), "calibration.json")
    calibration = read_calibration(path, name="cam0", imu_axes="flu")
    assert calibration.camera == Camera("double_sphere", 640, 480, 300, 301, 320, 240, (-0.2, 0.6))
    assert calibration.mount_rpy_rad == pytest.approx((0, 0, 0), abs=1e-9)
    assert read_calibration(path, name="cam1").camera.distortion == (0.1, 0.2, 0.3, 0.4)
    assert read_calibration(path, name="cam2").camera.distortion == (0.7, 1.0)
    with pytest.raises(InputError, match="'cylinder', a lens model that is not known"):
        read_calibration(path, name="cam3")


COLMAP = """# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152 -0.0218531
2 OPENCV_FISHEYE 640 480 300 301 320.5 240.5 0.1 0.2 0.3 0.4
3 THIN_PRISM_FISHEYE 320 240 300 301 160 120 0 0 0 0 0 0 0 0
"""


def test_colmap(tmp_path: Path) -> None:
    path = write(tmp_path, COLMAP, "cameras.txt")
    first = read_calibration(path, size=(3072, 2304)).camera
    assert first == Camera("radtan", 3072, 2304, 2559.81, 2559.81, 1535.5, 1151.5, (-0.0218531, 0, 0, 0, 0))
    second = read_calibration(path, name="2").camera
    assert second == Camera("kannala_brandt", 640, 480, 300, 301, 320.0, 240.0, (0.1, 0.2, 0.3, 0.4))
    with pytest.raises(InputError, match="THIN_PRISM_FISHEYE, which is not known"):
        read_calibration(path, name="3")


BOMB = "a: &a [x, x]\n" + "".join(
    f"{chr(98 + i)}: &{chr(98 + i)} [{', '.join(['*' + chr(97 + i)] * 9)}]\n" for i in range(12)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB, "aliases"),
        ("a: " + "[" * 5000 + "]" * 5000, "levels"),
        ('{"a": ' + "[" * 100000 + "]" * 100000 + "}", "levels|not valid JSON"),
        ("fx: " + ":".join(["1"] * 100000), "digits|value"),
        ("fx: " + "9" * 10000, "digits|value"),
        ("# " + "x" * (5 << 20), "larger than"),
        (
            '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]><opencv_storage>&b;</opencv_storage>',
            "no use for",
        ),
        ("<opencv_storage>" + "<a>" * 3000 + "</a>" * 3000 + "</opencv_storage>", "levels"),
        ("<calibration><f>3</f></calibration>", "root <calibration>"),
        ("<opencv_storage><a></opencv_storage>", "not valid XML"),
        ("name: camera\nfocal: 300\nsomething: else\n", "no known kind .*name.*focal.*something"),
        ("model: fisheye624\nwidth: 3\n", "one of pinhole"),
        ("cam0: {camera_model: pinhole, intrinsics: [[[[1]]]], resolution: [1, 1]}\n", "intrinsics"),
    ],
)
def test_hostile_and_foreign_files_cost_little(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    begin = time.perf_counter()
    with pytest.raises(InputError, match=message) as caught:
        read_calibration(path)
    assert time.perf_counter() - begin < 5.0
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 600


def test_every_verb_says_it_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import make_sets

    folder = make_sets.images_csv(tmp_path / "set", ["images/0.png,0.0,0.0,0.0,0.0,1.5"])
    (folder / "camera.yaml").write_text(BOMB)
    assert main(["check-data", str(folder)]) == 2
    assert "aliases" in capsys.readouterr().err
