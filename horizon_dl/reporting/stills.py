"""Frames for the browser of a page: a bounded number, evenly spread, and those that went worst."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, Truth
from horizon_dl.data.view import View
from horizon_dl.metrics.roc import frame_auc
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.file_sinks import drawn_ranges
from horizon_dl.visualization.film_picture import title_of
from horizon_dl.visualization.overlays import shrink_truth

Floats = NDArray[np.floating]

MOST_FRAMES, MOST_WORST = 12, 10


@dataclass(frozen=True)
class Said:
    """What one learner says of a frame; maps (h, w).

    Attributes:
        score: the entropy, which the paper's threshold belongs to.
        p_above: probability of above.
        ranges: the bearings that are flown, drawn, or None.
        auc: of the score that is flown on this frame alone, below the horizon; None without truth.
    """

    score: NDArray[np.float16]
    p_above: NDArray[np.float16]
    ranges: Image | None
    auc: float | None


@dataclass(frozen=True)
class Still:
    """One frame of the browser, with what each learner says of it."""

    name: str
    time_s: float
    image: Image
    elevation: Floats
    truth: NDArray[np.uint8] | None
    said: Mapping[str, Said]
    words: str = ""


def auc_of(view: View, score: Floats, truth: NDArray[np.uint8] | None) -> float | None:
    """AUC of obstacle against floor below the horizon of one frame, at the working size."""
    if truth is None:
        return None
    small = shrink_truth(truth, score.shape[1], score.shape[0])
    with np.errstate(invalid="ignore"):
        used = np.isin(small, (Truth.FLOOR, Truth.OBSTACLE)) & (view.elevation < 0)
    return frame_auc(np.asarray(score[used], np.float32), small[used] == Truth.OBSTACLE)


def said_of(prediction: Prediction, ranges: Ranged | None, auc: float | None) -> Said:
    """What a learner's prediction says."""
    found = prediction.measures
    drawn = None if ranges is None else drawn_ranges(prediction, ranges)
    return Said(found.entropy.astype(np.float16), found.p_above.astype(np.float16), drawn, auc)


def still(frame: Frame, view: View, said: Mapping[str, Said], ranges: Ranged | None) -> Still:
    """A frame for the browser."""
    truth = None
    if frame.truth is not None:
        truth = shrink_truth(frame.truth, view.image.shape[1], view.image.shape[0])
    return Still(frame.name, frame.time_s, view.image, view.elevation, truth, said, title_of(ranges))


@dataclass
class Stills:
    """Gathers frames as they come, however many, in bounded memory; what is not kept is not drawn.

    Attributes:
        even: evenly spread; their distance doubles whenever there are too many.
        worst: with the lowest AUC.
    """

    even: list[tuple[int, Still]] = field(default_factory=list)
    worst: list[tuple[float, int, Still]] = field(default_factory=list)
    count: int = 0
    _step: int = 1

    def add(self, auc: float | None, draw: Callable[[], Still]) -> None:
        """Take a frame.

        Args:
            auc: that says whether it is one of the worst; None without truth.
            draw: makes the still.
        """
        index = self.count
        self.count += 1
        even = index % self._step == 0
        worst = auc is not None and (len(self.worst) < MOST_WORST or auc < self.worst[-1][0])
        if not even and not worst:
            return
        one = draw()
        if even:
            self.even.append((index, one))
            if len(self.even) > 2 * MOST_FRAMES:
                self._step *= 2
                self.even = [pair for pair in self.even if pair[0] % self._step == 0]
        if auc is not None and worst:
            self.worst.append((auc, index, one))
            self.worst = sorted(self.worst, key=lambda entry: entry[:2])[:MOST_WORST]

    def chosen(self) -> list[Still]:
        """All kept frames in order."""
        kept = dict(self.even) | {index: one for _, index, one in self.worst}
        return [kept[index] for index in sorted(kept)]
