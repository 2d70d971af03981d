"""All kinds of targets by name."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import InputError
from horizon_dl.geometry.view import View
from horizon_dl.targets.geodesic import geodesic_target
from horizon_dl.targets.guided import guided_target
from horizon_dl.targets.hard import hard_target

TARGETS: dict[str, Callable[..., NDArray[np.float32]]] = {
    "hard": hard_target,
    "guided": guided_target,
    "geodesic": geodesic_target,
}


def make_target(kind: str, view: View, **parameters: Any) -> NDArray[np.float32]:
    """The target of one view: (h, w) float32 in [0, 1], 1 above; NaN where nothing is known.

    Args:
        kind: a name in `TARGETS`.
        view: image and elevation.
        parameters: passed on to the target's function.

    Raises:
        InputError: if the kind is not known.

    Example:
        `make_target("guided", view, eps=0.003)`
    """
    if kind not in TARGETS:
        raise InputError("target", f"{kind!r} is not known", f"use one of {', '.join(TARGETS)}")
    return TARGETS[kind](view.image, view.elevation, **parameters)
