"""Running figures of a stream: what a learner is worth now, not on the average since the start."""

from collections import deque

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.geometry.horizon import ABOVE, IGNORED, horizon_label
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.training.checkpoint import Snapshot

WINDOW_FRAMES = 50


class RunningSides:
    """Horizon accuracy and calibration of `p_above` against the side, over the last 50 frames."""

    def __init__(self) -> None:
        self._frames: deque[tuple[int, int, Reliability]] = deque(maxlen=WINDOW_FRAMES)

    def update(self, p_above: NDArray[np.float32], elevation: NDArray[np.float32], band_rad: float) -> None:
        """Count the pixels of one frame outside the ignore band."""
        label = horizon_label(elevation, band_rad)
        used = label != IGNORED
        above = label[used] == ABOVE
        calibration = Reliability()
        calibration.update(p_above[used], above)
        self._frames.append((int(np.sum((p_above[used] > 0.5) == above)), int(used.sum()), calibration))

    @property
    def horizon_accuracy(self) -> float | None:
        """Share of pixels whose side was predicted; None before any."""
        total = sum(pixels for _, pixels, _ in self._frames)
        return sum(right for right, _, _ in self._frames) / total if total else None

    @property
    def calibration_error(self) -> float | None:
        """Expected calibration error as of `Reliability`, in [0, 1]; None before any pixel."""
        together = Reliability()
        for _, _, calibration in self._frames:
            together.merge(calibration)
        return together.compute()

    def snapshot(self) -> Snapshot:
        """The window."""
        tensors = {
            f"{place}{name}": torch.from_numpy(array)
            for place, (_, _, calibration) in enumerate(self._frames)
            for name, array in vars(calibration).items()
        }
        return Snapshot(tensors, {"sides": [[right, pixels] for right, pixels, _ in self._frames]})

    def restore(self, snapshot: Snapshot) -> None:
        """The window of a snapshot."""
        self._frames.clear()
        for place, (right, pixels) in enumerate(snapshot.values["sides"]):
            calibration = Reliability()
            for name in vars(calibration):
                setattr(calibration, name, snapshot.tensors[f"{place}{name}"].numpy().copy())
            self._frames.append((right, pixels, calibration))
