"""What a model says of a frame, be it a run folder's net, an exported file or a learner at work."""

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.data.source import FrameSource
from horizon_dl.data.view import View
from horizon_dl.evidence.place import Place
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.uncertainty.measures import Measures, p_other_side
from horizon_dl.uncertainty.obstacle_map import obstacle_map

FLOWN_SCORE = "surprisal"
"""The product's own score: what is flown is where it rises along a bearing, and reports are headed by it."""
PAPER_SCORE = "entropy"
"""The paper's score; the paper's threshold on it gives the obstacle map that stands beside what is flown."""


@dataclass(frozen=True)
class Prediction:
    """What a model says of one frame; all maps (h, w), of the working size.

    Attributes:
        view: the frame at that size; its elevation is NaN where no attitude is known.
        measures: maps; without attitude the surprisal means nothing.
        threshold: the paper's, of the entropy, bits.
        obstacles: the entropy over the threshold, lone pixels removed: the paper's obstacle map.
        directions: (h, w, 3) unit rays, optical frame, NaN where not valid; None without a camera.
        place: limits for the evidence of free sectors; None where the model has none.
        rules: by which it is ranged and judged.
    """

    view: View
    measures: Measures
    threshold: float
    obstacles: NDArray[np.bool_]
    directions: NDArray[np.float32] | None = None
    place: Place | None = None
    rules: FlightRules = field(default_factory=FlightRules)

    @classmethod
    def of(
        cls, view: View, measures: Measures, threshold: float, directions: NDArray[np.float32] | None = None
    ) -> "Prediction":
        """With the paper's obstacle map."""
        obstacles = obstacle_map(measures.entropy, threshold)
        return cls(view, measures, threshold, obstacles, directions)

    @property
    def has_attitude(self) -> bool:
        """Whether the horizon is known, without which nothing is flown."""
        return not bool(np.isnan(self.view.elevation).all())

    @property
    def flown_score(self) -> NDArray[np.float32]:
        """(h, w) in [0, 1], the surprisal as the probability of the other side; needs an attitude."""
        return p_other_side(self.measures.p_above, self.view.elevation > 0)

    def arrays(self) -> dict[str, Any]:
        """All maps by name, the float ones as float16."""
        maps = {name: value.astype(np.float16) for name, value in vars(self.measures).items()}
        return {**maps, "obstacles": self.obstacles, "elevation_rad": self.view.elevation}


class Predictor(Protocol):
    """What says something of frames: a run folder, an exported file.

    Attributes:
        name: for titles.
        trained_on: name of the data it has learned from, or None.
        doubt: what it says of itself where it is not to be trusted without a look; None for nothing.
    """

    name: str
    trained_on: str | None
    doubt: str | None

    def check(self, source: FrameSource) -> None:
        """InputError where no frame of the source can be predicted, as those of another camera."""
        ...

    def predict(self, frame: Frame) -> Prediction:
        """The prediction of one frame, with or without attitude; FrameError where it does not fit."""
        ...

    def note(self) -> str | None:
        """What a user should know of how frames were predicted, in a sentence; None for nothing."""
        ...
