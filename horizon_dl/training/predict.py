"""A trained net on new images, with or without attitude."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View, any_view
from horizon_dl.models.net_measures import net_measures
from horizon_dl.training.run_folder import Run
from horizon_dl.uncertainty.measures import Measures
from horizon_dl.uncertainty.obstacle_map import obstacle_map


@dataclass(frozen=True)
class Prediction:
    """What a net says of one frame.

    Attributes:
        view: the frame at the working size; its elevation is NaN where no attitude is known.
        measures: maps of that size; without attitude the surprisal means nothing.
        obstacles: (h, w) bool, entropy over the run's threshold, lone pixels removed.
    """

    view: View
    measures: Measures
    obstacles: NDArray[np.bool_]

    def arrays(self) -> dict[str, Any]:
        """All maps by name, the float ones as float16."""
        maps = {name: value.astype(np.float16) for name, value in vars(self.measures).items()}
        return {**maps, "obstacles": self.obstacles, "elevation_rad": self.view.elevation}


def predict(run: Run, frame: Frame) -> Prediction:
    """Measures and obstacle map of one frame, with or without attitude."""
    view = any_view(frame, run.config.image.max_pixels)
    found = net_measures(run.net, view.image, view.elevation > 0)
    return Prediction(view, found, obstacle_map(found.entropy, run.threshold))
