"""The training-free baselines as methods: what a learner has to beat to have learned anything."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View
from horizon_dl.methods import baselines
from horizon_dl.methods.names import DIFFUSION, POSITION
from horizon_dl.methods.names import GEODESIC as GEODESIC_NAME
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams

Map = NDArray[np.float32]


@dataclass(frozen=True)
class TrainingFree:
    """A baseline with the one score `score`."""

    score: Callable[[View], Map]

    def score_maps(self, _: Frame, view: View) -> dict[str, Map]:
        """`score` alone, (h, w) in [0, 1]."""
        return {"score": self.score(view)}


def training_free_methods(paths: GeodesicParams = GEODESIC) -> dict[str, TrainingFree]:
    """The baselines by the names they have in `metrics.json`; `paths`: what those of `geodesic` cost."""
    return {
        DIFFUSION: TrainingFree(baselines.diffusion_score),
        GEODESIC_NAME: TrainingFree(partial(baselines.geodesic_score, paths=paths)),
        POSITION: TrainingFree(lambda view: baselines.position_score(view.elevation)),
    }
