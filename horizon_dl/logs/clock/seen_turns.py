"""How the camera turned from one picture to the next, from the pictures alone.

A whole number of pixels is found by phase correlation; what is left, by least squares over all pixels: the
change of brightness that a small turn about each of the camera's axes would make (Lucas and Kanade 1981, with
the three turns as unknowns in place of a shift). Travel moves pictures, too, but not as a turn does.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import camera_rays, project

Floats = NDArray[np.float64]

SMALL_PIXELS = 96 * 72
LEAST_OVERLAP = 0.3
ROBUST_STEPS = 2
BORDER = 2


@dataclass(frozen=True)
class SmallCamera:
    """A camera at the size at which turns are measured.

    Attributes:
        width, height: pixels.
        flows: (3, height, width, 2) how a pixel moves for a turn of 1 rad about each optical axis.
    """

    width: int
    height: int
    flows: Floats


def small_camera(camera: Camera) -> SmallCamera:
    """The camera, reduced, with the flow of each pixel; 0 where a pixel has no ray."""
    small = camera.reduced(SMALL_PIXELS)
    directions = camera_rays(small).directions.reshape(-1, 3).astype(np.float64)
    step = 1e-3
    flows = []
    for axis in np.eye(3):
        # A camera that turns by w sees a fixed direction d move by -w x d.
        moved = [directions - sign * step * np.cross(axis, directions) for sign in (1.0, -1.0)]
        with np.errstate(invalid="ignore"):
            flows.append((project(small, moved[0]) - project(small, moved[1])) / (2 * step))
    shape = (3, small.height, small.width, 2)
    return SmallCamera(small.width, small.height, np.nan_to_num(np.array(flows)).reshape(shape))


def small_grey(image: NDArray[np.uint8], camera: SmallCamera) -> Floats:
    """The picture in grey (height, width), of even contrast."""
    reduced = Image.fromarray(image).convert("L").resize((camera.width, camera.height), Image.Resampling.BOX)
    grey = np.asarray(reduced, np.float64)
    smooth = grey / 2
    for axis, shift in ((0, 1), (0, -1), (1, 1), (1, -1)):
        smooth = smooth + np.roll(grey, shift, axis) / 8
    return np.asarray((smooth - smooth.mean()) / max(float(smooth.std()), 1.0))


def seen_turn(camera: SmallCamera, before: Floats, now: Floats) -> Floats:
    """Turn (3,) of the camera about its optical axes between two pictures, rad; NaN where it cannot be told.

    Args:
        camera: of `small_camera`.
        before: of `small_grey`.
        now: the later one.
    """
    right, down = _shift(before, now)
    height, width = before.shape
    if (height - abs(down)) * (width - abs(right)) < LEAST_OVERLAP * height * width:
        return np.full(3, np.nan)
    old = (slice(max(0, -down), height - max(0, down)), slice(max(0, -right), width - max(0, right)))
    new = (slice(max(0, down), height - max(0, -down)), slice(max(0, right), width - max(0, -right)))
    first, second, flows = before[old], now[new], camera.flows[:, *old]
    inner = (slice(BORDER, -BORDER), slice(BORDER, -BORDER))
    mean = (first + second) / 2
    slope_down, slope_right = np.gradient(mean, axis=0)[inner], np.gradient(mean, axis=1)[inner]
    change = (second - first)[inner] - slope_right * right - slope_down * down
    columns = [flow[inner][..., 0] * slope_right + flow[inner][..., 1] * slope_down for flow in flows]
    return _solve(np.stack([column.ravel() for column in columns], axis=-1), -change.ravel())


def _solve(columns: Floats, wanted: Floats) -> Floats:
    """Least squares, with less weight for what fits badly."""
    weights = np.ones(len(wanted))
    turn = np.full(3, np.nan)
    for _ in range(1 + ROBUST_STEPS):
        weighted = columns * weights[:, None]
        normal = weighted.T @ columns
        if np.linalg.cond(normal) > 1e8:
            return np.full(3, np.nan)
        turn = np.linalg.solve(normal, weighted.T @ wanted)
        left = np.abs(columns @ turn - wanted)
        usual = 1.5 * float(np.median(left)) + 1e-6
        weights = 1.0 / np.maximum(1.0, left / usual)
    return turn


def _shift(before: Floats, now: Floats) -> tuple[int, int]:
    """Whole pixels by which the scene moved to the right and down, by phase correlation."""
    window = np.outer(np.hanning(before.shape[0]), np.hanning(before.shape[1]))
    spectrum = np.conj(np.fft.rfft2(before * window)) * np.fft.rfft2(now * window)
    peak = np.fft.irfft2(spectrum / (np.abs(spectrum) + 1e-9), before.shape)
    down, right = np.unravel_index(int(peak.argmax()), peak.shape)
    half_height, half_width = before.shape[0] // 2, before.shape[1] // 2
    return (
        int((right + half_width) % before.shape[1] - half_width),
        int((down + half_height) % before.shape[0] - half_height),
    )
