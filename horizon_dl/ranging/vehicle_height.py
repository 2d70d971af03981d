"""How high a vehicle is: what is lower than it does not block its way."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class VehicleHeight:
    """How far a vehicle reaches below and above its camera, m; ValueError for what cannot be.

    What is lower than `below_m` under the camera is flown or driven over. `above_m` decides nothing in
    flight, as nothing tells how far away things are that hang in the air; it does in measured distances.
    """

    below_m: float
    above_m: float

    def __post_init__(self) -> None:
        if not all(0 <= value < math.inf for value in (self.below_m, self.above_m)):
            raise ValueError("both heights are metres from zero on")


CAMERA_ALONE = VehicleHeight(0.0, 0.0)
"""Only what reaches the camera's height is in the way: the paper's own definition of an obstacle."""
