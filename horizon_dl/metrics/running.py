"""Running figures of a stream: what a learner is worth now, not on the average since the start."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.horizon import ABOVE, IGNORED, horizon_label
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.metric import State, joined_states, part_of

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

    def merge(self, other: "RunningSides") -> None:
        """See `Metric`; the other's frames are the newer ones."""
        self._frames += other._frames

    def compute(self) -> dict[str, float | None]:
        """`horizon_accuracy`, the share of pixels whose side was predicted, and `calibration_error`.

        Both in [0, 1], None before any pixel; the error is that of `Reliability`.
        """
        total = sum(pixels for _, pixels, _ in self._frames)
        together = Reliability()
        for _, _, calibration in self._frames:
            together.merge(calibration)
        right = sum(right for right, _, _ in self._frames)
        return {
            "horizon_accuracy": right / total if total else None,
            "calibration_error": together.compute(),
        }

    def state(self) -> State:
        """See `Metric`: the window."""
        sides = np.array([[right, pixels] for right, pixels, _ in self._frames], np.int64).reshape(-1, 2)
        frames = {f"frame{place}": calibration for place, (_, _, calibration) in enumerate(self._frames)}
        return {"sides": sides, **joined_states(frames)}

    def load(self, state: State) -> None:
        """See `Metric`."""
        self._frames.clear()
        for place, (right, pixels) in enumerate(state["sides"].tolist()):
            calibration = Reliability()
            calibration.load(part_of(state, f"frame{place}"))
            self._frames.append((right, pixels, calibration))
