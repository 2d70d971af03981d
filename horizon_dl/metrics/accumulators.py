"""What one method earns on the test frames."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import Frame, Truth
from horizon_dl.data.view import View
from horizon_dl.geometry.horizon import ABOVE, IGNORED, elevation, horizon_label
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.resize import nearest
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.uncertainty.measures import P_ABOVE
from horizon_dl.uncertainty.obstacle_map import without_lone_pixels


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

    def compute(self) -> tuple[float | None, float | None]:
        """True- and false-positive rate; None for a missing class."""
        return (
            self.hits / self.obstacles if self.obstacles else None,
            self.false_alarms / self.floor if self.floor else None,
        )


@dataclass
class MethodAccumulator:
    """Figures of one method under one seed, gathered frame by frame in bounded memory.

    Attributes:
        rocs: by score, below the horizon.
        other_rocs: of other pixels than those, by their name and by score: `above`, `crossing`, `low`.
        calibration: of `p_above`, outside the ignore band.
    """

    rocs: dict[str, RocAccumulator] = field(default_factory=dict)
    other_rocs: dict[str, dict[str, RocAccumulator]] = field(default_factory=dict)
    calibration: Reliability = field(default_factory=Reliability)
    raw: Confusion = field(default_factory=Confusion)
    filtered: Confusion = field(default_factory=Confusion)
    threshold: float | None = None
    right_sides: int = 0
    sides: int = 0
    frames: int = 0
    predict_s: float = 0.0
    train_s: float = 0.0

    def add_time(self, seconds: float) -> None:
        """Count a frame and the time its prediction took."""
        self.frames += 1
        self.predict_s += seconds

    def add_scores(
        self,
        maps: Mapping[str, NDArray[np.float32]],
        pixels: ScoredPixels,
        others: Mapping[str, ScoredPixels] | None = None,
    ) -> None:
        """Count every score map (all but `p_above`) at the scored pixels, and at others by name."""
        for name, score in maps.items():
            if name != P_ABOVE:
                values = enlarged(score, pixels.mask.shape)
                _add_to(self.rocs, name, values, pixels)
                for other, its_pixels in (others or {}).items():
                    if its_pixels.mask.any():
                        _add_to(self.other_rocs.setdefault(other, {}), name, values, its_pixels)

    def add_obstacle_map(self, score: NDArray[np.float32], threshold: float, pixels: ScoredPixels) -> None:
        """Count the obstacle map before and after its filter."""
        over = score > threshold
        self.raw.update(over, pixels)
        self.filtered.update(without_lone_pixels(over), pixels)

    def add_sides(self, view: View, p_above: NDArray[np.float32], band_rad: float) -> None:
        """Count the pixels outside the ignore band whose side of the horizon was predicted rightly."""
        label = horizon_label(view.elevation, band_rad)
        counts = label != IGNORED
        above = label[counts] == ABOVE
        self.right_sides += int(np.sum((p_above > 0.5)[counts] == above))
        self.sides += int(np.sum(counts))
        self.calibration.update(p_above[counts], above)


def _add_to(
    rocs: dict[str, RocAccumulator], name: str, values: NDArray[np.float32], pixels: ScoredPixels
) -> None:
    roc = rocs.setdefault(name, RocAccumulator())
    roc.update(values[pixels.mask], pixels.obstacle, pixels.depression_rad)
