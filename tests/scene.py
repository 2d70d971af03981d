"""A made-up frame with a prediction: a floor, a sky, and a box that stands on the floor."""

import math
from dataclasses import replace

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.uncertainty.measures import measures

WIDTH, HEIGHT = 160, 120
CAMERA = Camera("pinhole", WIDTH, HEIGHT, 120.0, 120.0, 79.5, 59.5)


def scene(index: int = 0, time_s: float | None = None, pitch_rad: float = 0.1) -> tuple[Frame, Prediction]:
    """Frame number `index`, its box a little further right each time."""
    up = np.array([0.0, -math.cos(pitch_rad), -math.sin(pitch_rad)])
    directions = camera_rays(CAMERA).directions
    angle = elevation(directions, up)
    image = np.where(angle[..., None] > 0, (150, 190, 230), (90, 110, 60)).astype(np.uint8)
    truth = np.where(angle > 0, 3, 1).astype(np.uint8)
    box = (slice(40, 85), slice(30 + 3 * index % 60, 60 + 3 * index % 60))
    image[box], truth[box] = (200, 90, 30), 2
    p_above = np.where(angle > 0, 0.97, 0.03).astype(np.float32)
    p_above[box] = 0.45
    rng = np.random.default_rng(index)
    samples = np.clip(p_above + rng.normal(0, 0.01 + 0.02 * (index % 3), (4, HEIGHT, WIDTH)), 0, 1)
    frame = Frame(
        f"cam/{index:03d}.png",
        0.2 * index if time_s is None else time_s,
        up_cam=up,
        height_m=1.2,
        image=image,
        camera=CAMERA,
        truth=truth,
    )
    view = View(image, angle.astype(np.float32))
    return frame, Prediction.of(view, measures(samples, angle > 0), 0.5, directions)


def plain(frame: Frame) -> Frame:
    """The frame as a picture of which nothing is known."""
    return replace(frame, up_cam=None, camera=None, height_m=None, truth=None)
