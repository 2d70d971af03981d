"""Obstacle scores without any learning, which every learner has to beat.

All are (h, w) float32 in [0, 1] and grow with the suspicion of an obstacle; 0 where the elevation is NaN.
"""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.view import View
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams
from horizon_dl.targets.targets import make_target
from horizon_dl.uncertainty.measures import p_other_side


def position_score(elevation: NDArray[np.float32]) -> NDArray[np.float32]:
    """Nearness to the horizon alone: 1 on the horizon, falling linearly to 0 straight down (or up).

    Args:
        elevation: (h, w) rad.
    """
    nearness = 1.0 - np.abs(elevation) / (np.pi / 2.0)
    return np.nan_to_num(np.clip(nearness, 0.0, 1.0)).astype(np.float32)


def diffusion_score(view: View) -> NDArray[np.float32]:
    """How much of the other side the guided filter brings to a pixel, from the frame's own horizon label."""
    return _other_side("guided", view)


def geodesic_score(view: View, paths: GeodesicParams = GEODESIC) -> NDArray[np.float32]:
    """How near the horizon is along paths through the image: 0.5 exp(-distance), at most 0.5."""
    return _other_side("geodesic", view, paths)


def _other_side(kind: str, view: View, paths: GeodesicParams = GEODESIC) -> NDArray[np.float32]:
    return np.nan_to_num(p_other_side(make_target(kind, view, params=paths), view.elevation > 0.0))
