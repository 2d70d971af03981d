"""Progressive validation: every frame of a stream is predicted and scored before it is learned from.

Also called prequential evaluation (Dawid 1984; Gama et al., On evaluating stream learning algorithms, Machine
Learning 2013). `compare --protocol prequential` and `online` count by this one class.
"""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View
from horizon_dl.evaluation.protocols import WARM_UP_FRAMES
from horizon_dl.evaluation.scoring import ScoredFrame, count_frame
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.uncertainty.measures import P_ABOVE
from horizon_dl.uncertainty.threshold import PaperThreshold

Map = NDArray[np.float32]
ScoreMaps = Mapping[str, Mapping[str, Map]]


class ProgressiveValidation:
    """Figures of methods over a stream.

    A method's threshold is the paper's over what it has predicted so far, the frame at hand not yet counted.
    Labelled frames after the first 20 are scored.

    Args:
        methods: their names.
        config: ignored band and percentile.

    Attributes:
        accumulators: by method.
        thresholds: by method.
        tested: frames scored with truth.
    """

    def __init__(self, methods: Iterable[str], config: Config) -> None:
        names = tuple(methods)
        self.accumulators = {name: MethodAccumulator() for name in names}
        self.thresholds = {name: PaperThreshold(config.threshold.percentile) for name in names}
        self.tested = 0
        self._band_rad = config.labels.band_rad

    @staticmethod
    def scores(index: int, frame: Frame) -> bool:
        """Whether the frame at a place in the stream will be scored, and all its score maps are needed."""
        return index >= WARM_UP_FRAMES and frame.truth is not None

    def update(self, index: int, frame: Frame, view: View, maps: ScoreMaps) -> ScoredFrame | None:
        """Count what methods that have learned something say of the next frame.

        Args:
            index: place in the stream.
            frame: with or without truth.
            view: of the frame.
            maps: by method: `p_above` and `entropy`, and all scores where `scores` says so.

        Returns:
            the frame with the thresholds it was scored by; None where it was not scored.
        """
        scored = None
        if self.scores(index, frame) and len(maps) == len(self.accumulators):
            thresholds = {name: self.thresholds[name].compute() for name in maps}
            scored = ScoredFrame(frame, view, maps, thresholds)
            count_frame(self.accumulators, scored, self._band_rad)
            self.tested += 1
        elif index >= WARM_UP_FRAMES:
            for name, found in maps.items():
                self.accumulators[name].add_sides(view, found[P_ABOVE], self._band_rad)
        labelled = labelled_pixels(view.elevation, self._band_rad)
        for name, found in maps.items():
            self.thresholds[name].update(found["entropy"], labelled)
        return scored
