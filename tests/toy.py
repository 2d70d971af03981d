"""A toy data set: a noisy floor, sky, and poles that cross the horizon; quick to learn."""

from pathlib import Path

import numpy as np
from PIL import Image

WIDTH, HEIGHT, FOCAL = 96, 72, 80.0
CAMERA = f"""model: pinhole
width: {WIDTH}
height: {HEIGHT}
fx: {FOCAL}
fy: {FOCAL}
cx: {(WIDTH - 1) / 2}
cy: {(HEIGHT - 1) / 2}
distortion: []
mount_rpy_deg: [0.0, 0.0, 0.0]
"""
HEADER = "image,time_s,roll_rad,pitch_rad,yaw_rad,height_m"


def write_toy_set(folder: Path, frames: int = 24, labels: bool = True) -> Path:
    """Write a set in the images + CSV format."""
    rng = np.random.default_rng(0)
    (folder / "images").mkdir(parents=True)
    (folder / "labels").mkdir()
    (folder / "camera.yaml").write_text(CAMERA)
    rows = [HEADER]
    for index in range(frames):
        pitch_rad = 0.08 * np.sin(index)
        image, truth = toy_frame(pitch_rad, rng)
        Image.fromarray(image).save(folder / "images" / f"{index:03d}.png")
        if labels:
            Image.fromarray(truth).save(folder / "labels" / f"{index:03d}.png")
        rows.append(f"images/{index:03d}.png,{index / 10},0.0,{pitch_rad},0.0,1.5")
    (folder / "frames.csv").write_text("\n".join(rows) + "\n")
    return folder


def toy_frame(pitch_rad: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Image and truth; nose up moves the horizon down."""
    horizon = (HEIGHT - 1) / 2 + FOCAL * np.tan(pitch_rad)
    rows = np.arange(HEIGHT)[:, None] * np.ones((1, WIDTH))
    above = rows < horizon
    image = np.where(above[..., None], (150, 190, 230), (90, 100, 60)).astype(float)
    truth = np.where(above, 3, 1).astype(np.uint8)
    for left in rng.integers(0, WIDTH - 12, 2):
        pole = (slice(6, int(horizon) + rng.integers(12, 22)), slice(left, left + 12))
        image[pole] = (200, 90, 30)
        truth[pole] = 2
    image += rng.normal(0, 12, image.shape)
    return image.clip(0, 255).astype(np.uint8), truth
