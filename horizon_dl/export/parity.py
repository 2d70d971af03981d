"""Does the file say what the learner says: torch or scikit-learn against onnxruntime at every level."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import onnxruntime
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View, make_view
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import nearest_pixels
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.forest import HorizonForest
from horizon_dl.runtime.model import OUTPUTS, new_session
from horizon_dl.uncertainty.measures import Measures, measures
from horizon_dl.uncertainty.obstacle_map import obstacle_map

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
Learner = HorizonFCN | HorizonForest


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


def parity(
    learner: Learner, max_pixels: int, threshold: float, content: bytes, frames: Sequence[Frame]
) -> dict[str, Any]:
    """Largest absolute differences between a learner's own predictions and its file's, by optimisation level.

    Obstacle maps are compared pixel by pixel; those whose entropy, or a neighbour's, lies within the
    tolerance of the threshold are ties and may differ. Surprisals are compared as probabilities.

    Args:
        learner: a net, or a forest.
        max_pixels: fixes the working size.
        threshold: of the entropy, bits.
        content: bytes of the file.
        frames: with attitude.
    """
    say = predictor(learner)
    views = [make_view(frame, max_pixels) for frame in frames]
    expected = [vars(say(view)) | {"elevation": view.elevation} for view in views]
    levels = {name: _level(content, frames, expected, threshold, level) for name, level in LEVELS.items()}
    return {
        "frames": len(frames),
        "tolerance": TOLERANCE,
        "good": all(one.good for one in levels.values()),
        "levels": {
            name: {**one.largest, "obstacle_pixels": one.obstacle_pixels, "beyond_ties": one.beyond_ties}
            for name, one in levels.items()
        },
    }


def predictor(learner: Learner) -> Callable[[View], Measures]:
    """What a learner itself says of a view."""
    if isinstance(learner, HorizonForest):
        return lambda view: measures(learner.p_above_samples(view), view.elevation > 0)
    return lambda view: EncodedImage(learner, view.image).measures(view.elevation > 0)


def sample_frames(camera: Camera, count: int = 3) -> list[Frame]:
    """Frames of smooth random colours and noise under random attitudes, for files exported without data."""
    rng = np.random.default_rng(0)
    frames = []
    for index in range(count):
        coarse = Image.fromarray(rng.integers(0, 256, (6, 8, 3), dtype=np.uint8))
        smooth = np.asarray(coarse.resize((camera.width, camera.height), Image.Resampling.BICUBIC))
        image = np.clip(smooth + rng.normal(0, 12, smooth.shape), 0, 255).astype(np.uint8)
        up_cam = np.array([0.0, -1.0, 0.0]) + rng.normal(0, 0.2, 3)
        up_cam /= np.linalg.norm(up_cam)
        frames.append(Frame(f"sample-{index}", float(index), up_cam, image=image, camera=camera))
    return frames


def feed_of(frame: Frame) -> Maps:
    """The graph's inputs of a frame with attitude."""
    if frame.up_cam is None:
        raise ValueError(f"{frame.name} has no attitude to compare with")
    return {"image": frame.image[None], "up_cam": frame.up_cam.astype(np.float32)}


def _level(
    content: bytes, frames: Sequence[Frame], expected: Sequence[Maps], threshold: float, level: Any
) -> Differences:
    session = new_session(content, 1, graph_optimization_level=level)
    found = Differences(dict.fromkeys(OUTPUTS[:-1], 0.0))
    for frame, reference in zip(frames, expected, strict=True):
        outputs = session.run(OUTPUTS, feed_of(frame))
        _compare(found, dict(zip(OUTPUTS, outputs, strict=True)), reference, threshold)
    return found


def _compare(found: Differences, maps: Maps, expected: Maps, threshold: float) -> None:
    for name in found.largest:
        one, other = maps[name].astype(np.float64), expected[name].astype(np.float64)
        if name == "surprisal":  # as a probability: the logarithm of nearly nothing is all rounding
            one, other = np.exp2(-one), np.exp2(-other)
        if not np.array_equal(np.isnan(one), np.isnan(other)):  # no assert: Python may be told to skip those
            raise RuntimeError(f"the exported file has NaN in other places: {name}")
        found.largest[name] = max(found.largest[name], float(np.nanmax(np.abs(one - other))))
    differs, ties = obstacle_differences(maps["obstacles"], expected["entropy"], threshold)
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
