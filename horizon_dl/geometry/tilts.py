"""Up directions that come into question for a camera that is held roughly upright, and doubt about them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ROLL_LIMIT, PITCH_LIMIT = np.radians(45.0), np.radians(50.0)
"""Beyond, a picture's verticals and its level edges cannot be told apart."""


@dataclass(frozen=True)
class UpEstimate:
    """Which way is up, as a picture says.

    Attributes:
        up_cam: (3,) unit, optical frame.
        sd_rad: standard deviation of its direction, rad: how far what else is likely lies from it.
    """

    up_cam: Floats
    sd_rad: float


def up_of(roll: Floats | float, pitch: Floats | float) -> Floats:
    """(..., 3) up in the optical frame of a camera in FRD with a roll and pitch, rad.

    Example:
        >>> up_of(0.0, 0.0).tolist()
        [-0.0, -1.0, 0.0]
    """
    parts = [-np.sin(roll) * np.cos(pitch), -np.cos(roll) * np.cos(pitch), np.sin(pitch) + 0.0 * roll]
    return np.stack([np.asarray(part, np.float64) for part in parts], axis=-1)


def roll_pitch_of(up_cam: Floats) -> tuple[float, float]:
    """Undoes `up_of`."""
    return float(np.arctan2(-up_cam[0], -up_cam[1])), float(np.arcsin(np.clip(up_cam[2], -1, 1)))


def tilts(step: float, centre: tuple[float, float] = (0.0, 0.0), reach: float | None = None) -> Floats:
    """(M, 3) up directions in a grid of roll and pitch.

    Args:
        step: of the grid, rad.
        centre: its roll and pitch, rad.
        reach: how far it goes on each side, rad; None: as far as the limits.
    """
    limits = (ROLL_LIMIT, PITCH_LIMIT) if reach is None else (reach, reach)
    roll, pitch = (
        at + np.arange(-limit, limit + step / 2, step) for at, limit in zip(centre, limits, strict=True)
    )
    return up_of(*(part.ravel() for part in np.meshgrid(roll, pitch, indexing="ij")))


def estimate(ups: Floats, log_likelihood: Floats) -> UpEstimate:
    """The likeliest of some directions, and how far the others that are likely, too, lie from it.

    Args:
        ups: (M, 3), evenly spread.
        log_likelihood: (M,).
    """
    best = ups[int(np.argmax(log_likelihood))]
    weight = np.exp(log_likelihood - log_likelihood.max())
    angle = np.arccos(np.clip(ups @ best, -1.0, 1.0))
    return UpEstimate(best, float(np.sqrt((weight * angle**2).sum() / weight.sum() / 2)))
