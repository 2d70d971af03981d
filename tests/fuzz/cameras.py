"""Camera files of every kind that is read, and bombs in them."""

import json
import random
from pathlib import Path

import make_sets

from fuzz.kind import Case
from fuzz.mutations import bomb, damaged
from horizon_dl.calibration.calibration import read_calibration

IDENTITY = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
MATRIX = "{rows: 3, cols: 3, data: [30, 0, 15, 0, 30, 11, 0, 0, 1]}"
OPENCV = (
    "%YAML:1.0\n---\nimage_width: 32\nimage_height: 24\ncamera_matrix: !!opencv-matrix\n"
    "  rows: 3\n  cols: 3\n  dt: d\n  data: [30., 0., 15., 0., 30., 11., 0., 0., 1.]\n"
)
POSE = {"px": 0, "py": 0, "pz": 0, "qx": -0.5, "qy": 0.5, "qz": -0.5, "qw": 0.5}
VINS = "%YAML:1.0\n---\nmodel_type: {}\ncamera_name: a\nimage_width: 640\nimage_height: 480\n"
XML_MATRIX = '<{0} type_id="opencv-matrix"><rows>{1}</rows><cols>{2}</cols><dt>d</dt><data>{3}</data></{0}>'


def _kalibr(model: str, intrinsics: str, bend: str, coefficients: str) -> str:
    return (
        f"cam0:\n  camera_model: {model}\n  distortion_model: {bend}\n  distortion_coeffs: {coefficients}\n"
        f"  intrinsics: {intrinsics}\n  resolution: [32, 24]\n  T_cam_imu: {IDENTITY}\n  rostopic: /a\n"
    )


def _basalt() -> str:
    lenses = [
        {"camera_type": kind, "intrinsics": {"fx": 30, "fy": 30, "cx": 15, "cy": 11, **values}}
        for kind, values in (
            ("ds", {"xi": -0.2, "alpha": 0.6}),
            ("kb4", dict.fromkeys(("k1", "k2", "k3", "k4"), 0.1)),
        )
    ]
    sizes = [[32, 24], [32, 24]]
    return json.dumps({"value0": {"T_imu_cam": [POSE] * 2, "intrinsics": lenses, "resolution": sizes}})


def _files() -> list[tuple[str, str]]:
    """Names and texts."""
    own = make_sets.CAMERA_YAML
    bent = own.replace("pinhole", "radtan").replace("[]", "[-0.3, 0.1, 0, 0, 0]", 1)
    xml = XML_MATRIX.format("camera_matrix", 3, 3, "30. 0. 15. 0. 30. 11. 0. 0. 1.")
    bend = "distortion_parameters: {k1: 0.1, k2: 0.2, p1: 0.3, p2: 0.4}\n"
    orb = "".join(
        f"Camera1.{key}: {value}\n"
        for key, value in (
            ("fx", 458.6),
            ("fy", 457.3),
            ("cx", 367.2),
            ("cy", 248.4),
            ("k1", -0.28),
            ("k2", 0.07),
        )
    )
    yaml_texts = [
        own,
        bent + "rotate_image: 90ccw\n",
        own.replace("mount_rpy_deg: [0.0, 0.0, 0.0]", "mount_rpy_deg: [1, -12, 0]\nimu_axes: flu"),
        "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
        "resolution: [32, 24]\ncamera_model: pinhole\nintrinsics: [30, 30, 15.5, 11.5]\n"
        "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n",
        OPENCV + "distortion_coefficients: [0.1, 0.0, 0.0, 0.0, 0.0]\n",
        OPENCV.replace("camera_matrix", "CameraMat") + "DistCoeff: [0.1, 0.0, 0.0, 0.0, 0.0]\n"
        f"CameraExtrinsicMat: {IDENTITY}\nImageSize: [32, 24]\n",
        _kalibr("pinhole", "[30, 30, 15, 11]", "radtan", "[0.1, 0, 0, 0]"),
        _kalibr("omni", "[1.5, 30, 30, 15, 11]", "radtan", "[0.1, 0, 0, 0]"),
        _kalibr("ds", "[-0.2, 0.6, 30, 30, 15, 11]", "none", "[]"),
        f"image_width: 32\nimage_height: 24\ndistortion_model: plumb_bob\ncamera_matrix: {MATRIX}\n"
        "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n",
        "height: 24\nwidth: 32\ndistortion_model: rational_polynomial\nD: [0.1, 0, 0, 0, 0, 0.1, 0, 0]\n"
        "K: [30, 0, 15, 0, 30, 11, 0, 0, 1]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nbinning_x: 0\n"
        "roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: False}\n---\n",
        VINS.format("PINHOLE") + bend + "projection_parameters: {fx: 300, fy: 301, cx: 320, cy: 240}\n",
        VINS.format("MEI") + bend + "mirror_parameters: {xi: 1.9}\n"
        "projection_parameters: {gamma1: 700, gamma2: 701, u0: 320, v0: 240}\n",
        '%YAML:1.0\nFile.version: "1.0"\nCamera.type: "PinHole"\n' + orb
        + "Camera.width: 752\nCamera.height: 480\nIMU.T_b_c1: !!opencv-matrix\n  rows: 4\n  cols: 4\n"
        f"  dt: f\n  data: {IDENTITY}\n",
    ]  # fmt: skip
    return [
        *(("camera.yaml", text) for text in yaml_texts),
        ("calibration.json", _basalt()),
        ("cameras.txt", "# Camera list\n1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152 -0.0218531\n"
         "2 OPENCV_FISHEYE 640 480 300 301 320.5 240.5 0.1 0.2 0.3 0.4\n"),
        ("camera.xml", '<?xml version="1.0"?>\n<opencv_storage><image_width>32</image_width><image_height>24'
         f"</image_height>{xml}{XML_MATRIX.format('distortion_coefficients', 5, 1, '0.1 0. 0. 0. 0.')}"
         "</opencv_storage>\n"),
    ]  # fmt: skip


def camera_file(folder: Path) -> Case:
    """Any kind of camera file; one of the cameras may be named, the size of pictures told."""
    folder.mkdir(parents=True)
    whole = _files()
    for name, text in whole:
        (folder / name).write_text(text)  # undamaged, every one is read
        one = {"cameras.txt": "1", "calibration.json": "cam0"}.get(name)
        read_calibration(folder / name, name=one, imu_axes="flu")

    def case(chance: random.Random) -> None:
        name, text = chance.choice(whole)
        if chance.random() < 0.05:
            text = chance.choice((bomb(chance), text + "\n" + bomb(chance)))
        (folder / name).write_bytes(damaged(text.encode(), chance))
        _read(folder / name, chance)

    return case


def _read(path: Path, chance: random.Random) -> None:
    name, size = (
        chance.choice((None, None, "cam0", "1", "x" * 300)),
        chance.choice((None, (32, 24), (3072, 2304))),
    )
    calibration = read_calibration(path, size=size, name=name, imu_axes=chance.choice((None, "flu", "frd")))
    assert calibration.camera.fx > 0
    assert len(calibration.mount_rpy_rad) == 3
