"""Writes tiny recordings of every format, for tests."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

CAMERA_YAML = (
    "model: pinhole\nwidth: 32\nheight: 24\nfx: 30.0\nfy: 30.0\ncx: 15.5\ncy: 11.5\n"
    "distortion: []\nmount_rpy_deg: [0.0, 0.0, 0.0]\n"
)
IDENTITY = "1 0 0 0 1 0 0 0 1"


def save_image(path: Path, width: int = 32, height: int = 24, grey: bool = False) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    shape = (height, width) if grey else (height, width, 3)
    Image.fromarray(np.full(shape, 90, dtype=np.uint8)).save(path)


def images_csv(
    folder: Path,
    rows: Sequence[str] = ("images/a.png,0.0,0.1,0.0,0.0,1.5", "images/b.png,0.1,0.0,0.2,0.0,1.4"),
    header: str = "image,time_s,roll_rad,pitch_rad,yaw_rad,height_m",
    camera: str = CAMERA_YAML,
) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "frames.csv").write_text("\n".join([header, *rows]) + "\n")
    (folder / "camera.yaml").write_text(camera)
    for row in rows:
        name = row.split(",")[0]
        if name.endswith(".png"):
            save_image(folder / name)
    return folder


def kitti(
    folder: Path, oxts: str = "49 8 110 0.0 0.0 0.0", drive: str = "2011_09_26_drive_0001_sync"
) -> Path:
    """One drive of two frames; axes of IMU and velodyne alike, camera looking along x."""
    date = folder / "2011_09_26"
    for index in range(2):
        save_image(date / drive / "image_02" / "data" / f"{index:010d}.png")
        path = date / drive / "oxts" / "data" / f"{index:010d}.txt"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(oxts + " 0" * 24 + "\n")
    (date / drive / "image_02" / "timestamps.txt").write_text(
        "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.064389445\n"
    )
    projection = "30 0 15.5 4 0 30 11.5 0.2 0 0 1 0.002"
    (date / "calib_cam_to_cam.txt").write_text(
        f"calib_time: 09-Jan-2012\nS_rect_02: 32 24\nR_rect_00: {IDENTITY}\nP_rect_02: {projection}\n"
    )
    (date / "calib_imu_to_velo.txt").write_text(f"R: {IDENTITY}\nT: 0 0 0\n")
    (date / "calib_velo_to_cam.txt").write_text("R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n")
    return folder


def paparazzi(folder: Path, start_s: float = 10.0, header: str | None = None, height_m: float = 1.0) -> Path:
    """Four images at 10.00, 10.05, ... s; a log at 100 Hz, the pitch growing by 1 rad/s."""
    for index in range(4):
        save_image(folder / "flight" / f"{10_000_000 + 50_000 * index}.jpg")
    lines = [header or "time,pos_z,att_phi,att_theta,att_psi,cmd_thrust"]
    for index in range(40):
        t = 0.01 * index
        lines.append(f"{start_s + t:.4f},{-height_m},0.0,{t:.4f},3.1,5000")
    (folder / "flight.csv").write_text("\n".join(lines) + "\n")
    (folder / "camera.yaml").write_text(CAMERA_YAML)
    return folder


def tum(
    folder: Path, start_s: float = 1000.0, comment: str = "# file: 'rgbd_dataset_freiburg3_x.bag'"
) -> Path:
    """Two images; the camera looks along the world's y axis, level, 1.2 m high, so that up is against v."""
    lines = [comment, "# timestamp filename"]
    for index in range(2):
        save_image(folder / "rgb" / f"{1000 + index / 10:.6f}.png", 640, 480)
        lines.append(f"{1000 + index / 10:.6f} rgb/{1000 + index / 10:.6f}.png")
    (folder / "rgb.txt").write_text("\n".join(lines) + "\n")
    # Optical axes in the world: x right = x, y down = -z, z forward = y: a turn by -90 degrees about x.
    half = np.sqrt(0.5)
    poses = [f"{start_s + 0.01 * i:.4f} 0 0 1.2 {-half} 0 0 {half}" for i in range(20)]
    (folder / "groundtruth.txt").write_text("\n".join([comment, *poses]) + "\n")
    return folder


def euroc(folder: Path, truth: bool = False, imu_start_ns: int = 0) -> Path:
    """Three grey images at 1.0, 1.1, 1.2 s; IMU x up, camera turned so that its v axis is against x."""
    root = folder / "mav0"
    lines = ["#timestamp [ns],filename"]
    for index in range(3):
        stamp = 1_000_000_000 + index * 100_000_000
        save_image(root / "cam0" / "data" / f"{stamp}.png", grey=True)
        lines.append(f"{stamp},{stamp}.png")
    (root / "cam0" / "data.csv").write_text("\r\n".join(lines) + "\r\n")
    (root / "cam0" / "sensor.yaml").write_text(
        "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
        "resolution: [32, 24]\ncamera_model: pinhole\nintrinsics: [30, 30, 15.5, 11.5]\n"
        "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n"
    )
    (root / "imu0").mkdir()
    samples = [f"{imu_start_ns + 5_000_000 * i},0,0,0,9.81,0,0" for i in range(300)]
    (root / "imu0" / "data.csv").write_text("\n".join(["#timestamp [ns],w,a", *samples]) + "\n")
    if truth:
        # World from body: a turn by -90 degrees about y takes the body's x axis to the world's z axis.
        half = np.sqrt(0.5)
        (root / "state_groundtruth_estimate0").mkdir()
        poses = [f"{50_000_000 * i},0,0,1,{half},0,{-half},0,0,0,0" for i in range(40)]
        (root / "state_groundtruth_estimate0" / "data.csv").write_text("\n".join(["#t", *poses]) + "\n")
    return folder
