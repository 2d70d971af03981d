"""Does the file say what the net says: torch against onnxruntime at every optimisation level."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import onnxruntime
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.frames.frame import Frame
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import nearest_pixels
from horizon_dl.geometry.view import make_view
from horizon_dl.learning.predict import Prediction, predict
from horizon_dl.learning.run import Run
from horizon_dl.obstacles.threshold import obstacle_map
from horizon_dl.onboard.model import OUTPUTS, new_session

LEVELS = {
    "none": onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL,
    "basic": onnxruntime.GraphOptimizationLevel.ORT_ENABLE_BASIC,
    "extended": onnxruntime.GraphOptimizationLevel.ORT_ENABLE_EXTENDED,
    "layout": onnxruntime.GraphOptimizationLevel.ORT_ENABLE_LAYOUT,
    "all": onnxruntime.GraphOptimizationLevel.ORT_ENABLE_ALL,
}
TOLERANCE = 1e-4
"""Of probabilities and bits; wider than float32 rounding, narrower than anything that matters."""

Maps = dict[str, NDArray[Any]]


@dataclass
class Differences:
    """Largest differences of one optimisation level over all frames."""

    largest: dict[str, float]
    obstacle_pixels: int = 0
    beyond_ties: int = 0

    @property
    def good(self) -> bool:
        """Whether the file may be flown."""
        return max(self.largest.values()) <= TOLERANCE and self.beyond_ties == 0


def parity(run: Run, content: bytes, frames: Sequence[Frame]) -> dict[str, Any]:
    """Largest absolute differences between a run's own predictions and its file's, by optimisation level.

    Obstacle maps are compared pixel by pixel; those whose entropy, or a neighbour's, lies within the
    tolerance of the threshold are ties and may differ. Surprisals are compared as probabilities.
    """
    wanted = [predict(run, make_view(frame, run.config.image.max_pixels)) for frame in frames]
    levels = {name: _level(run, content, frames, wanted, level) for name, level in LEVELS.items()}
    return {
        "frames": len(frames),
        "tolerance": TOLERANCE,
        "good": all(one.good for one in levels.values()),
        "levels": {
            name: {**one.largest, "obstacle_pixels": one.obstacle_pixels, "beyond_ties": one.beyond_ties}
            for name, one in levels.items()
        },
    }


def sample_frames(camera: Camera, count: int = 3) -> list[Frame]:
    """Frames of smooth random colours and noise under random attitudes, for files exported without data."""
    rng = np.random.default_rng(0)
    frames = []
    for index in range(count):
        coarse = Image.fromarray(rng.integers(0, 256, (6, 8, 3), dtype=np.uint8))
        smooth = np.asarray(coarse.resize((camera.width, camera.height), Image.Resampling.BICUBIC))
        image = np.clip(smooth + rng.normal(0, 12, smooth.shape), 0, 255).astype(np.uint8)
        up_cam = np.array([0.0, -1.0, 0.0]) + rng.normal(0, 0.2, 3)
        frames.append(Frame(f"sample-{index}", float(index), image, camera, up_cam / np.linalg.norm(up_cam)))
    return frames


def _level(
    run: Run, content: bytes, frames: Sequence[Frame], wanted: Iterable[Prediction], level: Any
) -> Differences:
    session = new_session(content, 1, graph_optimization_level=level)
    found = Differences(dict.fromkeys(OUTPUTS[:-1], 0.0))
    for frame, reference in zip(frames, wanted, strict=True):
        assert frame.up_cam is not None
        feed = {"image": frame.image[None], "up_cam": frame.up_cam.astype(np.float32)}
        _compare(found, dict(zip(OUTPUTS, session.run(OUTPUTS, feed), strict=True)), reference, run.threshold)
    return found


def _compare(found: Differences, maps: Maps, reference: Prediction, threshold: float) -> None:
    wanted: Maps = {**vars(reference.measures), "elevation": reference.view.elevation}
    for name in found.largest:
        if name == "surprisal":  # as a probability: the logarithm of nearly nothing is all rounding
            maps[name], wanted[name] = np.exp2(-maps[name]), np.exp2(-wanted[name])
        difference = np.abs(maps[name].astype(np.float64) - wanted[name])
        assert np.array_equal(np.isnan(maps[name]), np.isnan(wanted[name])), f"{name}: NaN in other places"
        found.largest[name] = max(found.largest[name], float(np.nanmax(difference)))
    differs, ties = obstacle_differences(maps["obstacles"], reference.measures.entropy, threshold)
    found.obstacle_pixels += int(differs.sum())
    found.beyond_ties += int((differs & ~ties).sum())


def obstacle_differences(
    obstacles: NDArray[np.uint8], entropy: NDArray[np.float32], threshold: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Where an obstacle map (H, W) differs from that of an entropy map (h, w), and where that is a tie."""
    near = np.pad(np.abs(entropy - threshold) <= TOLERANCE, 1)
    height, width = entropy.shape
    tie = np.zeros(entropy.shape, bool)
    for row in range(3):
        for column in range(3):
            tie |= near[row : row + height, column : column + width]
    pixels = np.ix_(*(nearest_pixels(n, m) for n, m in zip(entropy.shape, obstacles.shape, strict=True)))
    return obstacle_map(entropy, threshold)[pixels] != obstacles.astype(bool), tie[pixels]
