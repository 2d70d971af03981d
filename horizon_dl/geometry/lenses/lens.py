"""What every lens model offers."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Values = tuple[float, ...]

FREE = (-math.inf, math.inf)


@dataclass(frozen=True)
class Lens:
    """A lens model in units of its focal length: an image point (0, 0) is the optical axis.

    Focal lengths and principal point stay with the camera, so that every lens scales alike.

    Attributes:
        parameters: name of each parameter, in the order of `Camera.distortion`, and the closed interval that
            it may lie in.
        required: so many parameters, from the first on, have no default; the others are 0 where left out.
        project: points (N, 3) of any length, optical frame, and the values of the parameters, to image points
            (N, 2); NaN where the lens does not see the point.
        unproject: image points (N, 2) to rays (N, 3) of any length, and a mask (N,) of those that exist.
    """

    parameters: Mapping[str, tuple[float, float]]
    required: int
    project: Callable[[Floats, Values], Floats]
    unproject: Callable[[Floats, Values], tuple[Floats, Mask]]


def with_depth(plane: Floats, depth: Floats | float) -> Floats:
    """(N, 3) points of plane coordinates (N, 2) and a depth, (N,) or one for all."""
    return np.concatenate([plane, np.broadcast_to(depth, (len(plane),))[:, None]], axis=-1)


def divided(numerator: Floats, denominator: Floats, seen: Mask) -> Floats:
    """(N, 2) over (N,), NaN where not seen."""
    return np.asarray(numerator / np.where(seen, denominator, np.nan)[:, None])
