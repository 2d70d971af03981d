"""Where a frame is scored, and counts of right and wrong obstacle pixels there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import Frame, Truth
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.resize import nearest
from horizon_dl.metrics.metric import State


@dataclass(frozen=True)
class ScoredPixels:
    """The labelled pixels on one side of the horizon of one frame, at the truth's own size.

    Attributes:
        mask: (H, W) bool, which pixels.
        obstacle: (n,) bool, row by row.
        depression_rad: (n,) angle from the horizon, rad: its depression below, its elevation above.
    """

    mask: NDArray[np.bool_]
    obstacle: NDArray[np.bool_]
    depression_rad: NDArray[np.float32]

    def keep(self, kept: NDArray[np.bool_]) -> "ScoredPixels":
        """Only those of the pixels for which `kept`, (n,), is true."""
        mask = self.mask.copy()
        mask[self.mask] = kept
        return ScoredPixels(mask, self.obstacle[kept], self.depression_rad[kept])


def scored_pixels(frame: Frame, *, above: bool = False) -> ScoredPixels:
    """Where a frame is scored: nowhere without truth or attitude.

    Args:
        frame: with or without truth.
        above: take obstacles against ceiling and sky above the horizon, not against floor below it.
    """
    if frame.truth is None or frame.up_cam is None:
        nowhere = np.zeros(frame.image.shape[:2], bool)
        return ScoredPixels(nowhere, np.empty(0, bool), np.empty(0, np.float32))
    angle = elevation(camera_rays(frame.camera).directions, frame.up_cam)
    free, from_horizon = (Truth.ABOVE, angle) if above else (Truth.FLOOR, -angle)
    mask = np.isin(frame.truth, (free, Truth.OBSTACLE)) & (from_horizon > 0)
    return ScoredPixels(mask, frame.truth[mask] == Truth.OBSTACLE, from_horizon[mask])


def enlarged(score: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    """A score map in [0, 1], bilinearly enlarged to (H, W)."""
    size = (shape[1], shape[0])
    resized = Image.fromarray(score.astype(np.float32)).resize(size, Image.Resampling.BILINEAR)
    return np.asarray(resized, np.float32).clip(0.0, 1.0)


@dataclass
class Confusion:
    """Counts of right and wrong obstacle pixels."""

    hits: int = 0
    obstacles: int = 0
    false_alarms: int = 0
    floor: int = 0

    def update(self, obstacle_map: NDArray[np.bool_], pixels: ScoredPixels) -> None:
        """Count one frame's (h, w) map, enlarged to the truth's size."""
        found = nearest(obstacle_map, *pixels.mask.shape)[pixels.mask]
        self.hits += int(np.sum(found & pixels.obstacle))
        self.obstacles += int(np.sum(pixels.obstacle))
        self.false_alarms += int(np.sum(found & ~pixels.obstacle))
        self.floor += int(np.sum(~pixels.obstacle))

    def merge(self, other: "Confusion") -> None:
        """See `Metric`."""
        self.load({"counts": self.state()["counts"] + other.state()["counts"]})

    def state(self) -> State:
        """The four counts."""
        return {"counts": np.array([self.hits, self.obstacles, self.false_alarms, self.floor], np.int64)}

    def load(self, state: State) -> None:
        """See `Metric`."""
        self.hits, self.obstacles, self.false_alarms, self.floor = state["counts"].tolist()

    def compute(self) -> tuple[float | None, float | None]:
        """True- and false-positive rate; None for a missing class."""
        return (
            self.hits / self.obstacles if self.obstacles else None,
            self.false_alarms / self.floor if self.floor else None,
        )
