"""What a model says of a frame, be it a run folder's net, an exported file or a learner at work."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.data.source import FrameSource
from horizon_dl.data.view import View
from horizon_dl.evidence.place import Place
from horizon_dl.uncertainty.measures import Measures
from horizon_dl.uncertainty.obstacle_map import obstacle_map

DRAWN_SCORE = "entropy"
"""The measure that is drawn, thresholded into the obstacle map and reported as the product's own score."""


@dataclass(frozen=True)
class Prediction:
    """What a model says of one frame; all maps (h, w), of the working size.

    Attributes:
        view: the frame at that size; its elevation is NaN where no attitude is known.
        measures: maps; without attitude the surprisal means nothing.
        threshold: above which the score is an obstacle, in its unit.
        obstacles: the score over the threshold, lone pixels removed.
        directions: (h, w, 3) unit rays, optical frame, NaN where not valid; None without a camera.
        place: limits for the evidence of free sectors; None where the model has none.
    """

    view: View
    measures: Measures
    threshold: float
    obstacles: NDArray[np.bool_]
    directions: NDArray[np.float32] | None = None
    place: Place | None = None

    @classmethod
    def of(
        cls, view: View, measures: Measures, threshold: float, directions: NDArray[np.float32] | None = None
    ) -> "Prediction":
        """With the obstacle map that the score and its threshold make."""
        obstacles = obstacle_map(getattr(measures, DRAWN_SCORE), threshold)
        return cls(view, measures, threshold, obstacles, directions)

    @property
    def score(self) -> NDArray[np.float32]:
        """The map that the threshold belongs to."""
        score: NDArray[np.float32] = getattr(self.measures, DRAWN_SCORE)
        return score

    def arrays(self) -> dict[str, Any]:
        """All maps by name, the float ones as float16."""
        maps = {name: value.astype(np.float16) for name, value in vars(self.measures).items()}
        return {**maps, "obstacles": self.obstacles, "elevation_rad": self.view.elevation}


class Predictor(Protocol):
    """What says something of frames: a run folder, an exported file.

    Attributes:
        name: for titles.
        trained_on: name of the data it has learned from, or None.
    """

    name: str
    trained_on: str | None

    def check(self, source: FrameSource) -> None:
        """InputError where no frame of the source can be predicted, as those of another camera."""
        ...

    def predict(self, frame: Frame) -> Prediction:
        """The prediction of one frame, with or without attitude; FrameError where it does not fit."""
        ...

    def note(self) -> str | None:
        """What a user should know of how frames were predicted, in a sentence; None for nothing."""
        ...
