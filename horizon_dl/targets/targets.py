"""All kinds of targets by name."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.targets.geodesic import geodesic_target, one_way_target
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams
from horizon_dl.targets.guided import guided_target
from horizon_dl.targets.hard import hard_target

Map = NDArray[np.float32]

TARGETS: dict[str, Callable[..., Map]] = {
    "hard": hard_target,
    "guided": guided_target,
    "one_way_geodesic": one_way_target,
    "geodesic": geodesic_target,
}
LEARNING = ("one_way_geodesic", "geodesic")
"""Those that also follow what a net has learned so far."""


def make_target(kind: str, view: View, p_above: Map | None = None, params: GeodesicParams = GEODESIC) -> Map:
    """The target of one view: (h, w) float32 in [0, 1], 1 above; NaN where nothing is known.

    Args:
        kind: a name in `TARGETS`.
        view: image and elevation.
        p_above: (h, w) what a net says of the view; only the targets in `LEARNING` follow it.
        params: of the paths of those.

    Raises:
        InputError: if the kind is not known.
    """
    if kind not in TARGETS:
        raise InputError("target", f"{kind!r} is not known", f"use one of {', '.join(TARGETS)}")
    if kind in LEARNING:
        return TARGETS[kind](view.image, view.elevation, p_above, params)
    return TARGETS[kind](view.image, view.elevation)
