"""From sectors to the fields of MAVLink's OBSTACLE_DISTANCE (330), the message that autopilots avoid by.

What receivers do with it: PX4's Collision Prevention reads one element for each of its own sectors of 5
degrees, so elements narrower than that would be skipped; ArduPilot forgets the whole boundary with every
message and takes an element out of [min, max] for "no reading". Hence 72 elements of 5 degrees, the nearest
obstacle of each, and never a distance below the minimum.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.ranging.sectors import FreeDistances, Outcome

ELEMENTS = 72
UNKNOWN_CM = 65535
FULL_TURN_DEG = 360.0
COVERED = 0.9


@dataclass(frozen=True)
class MessageShape:
    """How distances are laid out; the defaults go all round.

    Attributes:
        increment_deg: width of an element.
        min_cm: nearer obstacles are reported at this distance, positive.
        max_cm: obstacles farther away are no obstacles, below 65534.
    """

    increment_deg: float = 5.0
    min_cm: int = 20
    max_cm: int = 1000

    def __post_init__(self) -> None:
        if not 0 < self.increment_deg <= FULL_TURN_DEG / ELEMENTS:
            raise ValueError(f"increment {self.increment_deg} deg is not in (0, 5]")
        if not 0 < self.min_cm < self.max_cm < UNKNOWN_CM - 1:
            raise ValueError(f"needs 0 < min ({self.min_cm} cm) < max ({self.max_cm} cm) < 65534 cm")

    @property
    def offset_deg(self) -> float:
        """Direction of the first element: forward if the elements go all round, else the left end."""
        all_round = math.isclose(self.increment_deg * ELEMENTS, FULL_TURN_DEG)
        return 0.0 if all_round else -(ELEMENTS - 1) / 2 * self.increment_deg

    @property
    def clear_cm(self) -> int:
        """Value of an element without obstacles."""
        return self.max_cm + 1


def distances_cm(found: FreeDistances | None, shape: MessageShape) -> NDArray[np.uint16]:
    """(72,) elements: the nearest obstacle's distance, `clear_cm`, or 65535 for unknown.

    An element is clear only if all of it is known to be free (or farther away than `max_cm`). Obstacles
    without metres are unknown, never an invented distance. One that covers the nearest visible ground is
    nearer than can be measured: it is reported at `min_cm`, so that every receiver stops before it. None is
    unknown everywhere.
    """
    elements = np.full(ELEMENTS, UNKNOWN_CM, np.uint16)
    if found is None or len(found.bearing_rad) < 2:
        return elements
    element = _element_of(found.bearing_rad, shape)
    with np.errstate(invalid="ignore"):
        cm = np.clip(np.floor(found.distance_m * 100), shape.min_cm, UNKNOWN_CM)
    covered = (found.outcome == Outcome.OBSTACLE) & ~found.contact_seen & np.isfinite(cm)
    cm = np.where(covered, shape.min_cm, cm)
    met = (found.outcome == Outcome.OBSTACLE) & (cm <= shape.max_cm)
    clear = (found.outcome != Outcome.UNKNOWN) & (cm > shape.max_cm)
    step_deg = math.degrees(float(found.bearing_rad[1] - found.bearing_rad[0]))
    for index in np.unique(element[element >= 0]).tolist():
        mine = element == index
        if (met & mine).any():
            elements[index] = cm[met & mine].min()
        elif clear[mine].all() and mine.sum() * step_deg >= COVERED * shape.increment_deg:
            elements[index] = shape.clear_cm
    return elements


def _element_of(bearing_rad: NDArray[np.float32], shape: MessageShape) -> NDArray[np.int64]:
    """(sectors,) the element that each sector's middle lies in, -1 for none."""
    away = np.degrees(bearing_rad.astype(np.float64)) - shape.offset_deg
    index = np.floor(away / shape.increment_deg + 0.5).astype(np.int64)
    if shape.offset_deg == 0.0:
        return index % ELEMENTS
    return np.where((index >= 0) & (index < ELEMENTS), index, -1)
