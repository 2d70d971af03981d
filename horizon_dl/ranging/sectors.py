"""What is known of the ground in each bearing."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]


class Outcome(IntEnum):
    """What is known of a bearing."""

    UNKNOWN = 0  # outside the view, no ground visible, or no attitude
    FREE = 1  # free from the nearest visible ground to the farthest
    OBSTACLE = 2


@dataclass(frozen=True)
class FreeDistances:
    """What is known in each bearing; arrays (sectors,).

    Attributes:
        bearing_rad: middle of the sector, clockwise from straight ahead.
        outcome: of `Outcome`.
        distance_m: level distance from the camera to the obstacle's ground contact; where free, that of the
            farthest ground in view: inf up to the horizon, less where the camera looks down. NaN where
            unknown, and without a height.
        sd_m: its standard deviation towards the camera; NaN where there is no finite distance.
        sd_beyond_m: and away from it: the same; more, if `free_distances_from_p` was asked, where the contact
            is not seen, as what is taken for an obstacle may be floor.
        depression_rad: of the contact, or of the farthest ground in view where free; NaN where unknown.
        contact_seen: False where the obstacle covers the nearest visible ground: it is at most that far away.
        nearest_rad: depression of the nearest ground that the camera sees; 0 outside of its view.
    """

    bearing_rad: Floats
    outcome: NDArray[np.uint8]
    distance_m: Floats
    sd_m: Floats
    sd_beyond_m: Floats
    depression_rad: Floats
    contact_seen: Mask
    nearest_rad: Floats


def no_distances(bearing_rad: Floats) -> FreeDistances:
    """`UNKNOWN` everywhere: what holds without an attitude or a picture."""
    nothing = np.full(len(bearing_rad), np.nan, np.float32)
    outcome = np.full(len(bearing_rad), Outcome.UNKNOWN, np.uint8)
    unseen = np.zeros(len(bearing_rad), np.bool_)
    zero = np.zeros(len(bearing_rad), np.float32)
    return FreeDistances(bearing_rad, outcome, nothing, nothing, nothing, nothing, unseen, zero)
