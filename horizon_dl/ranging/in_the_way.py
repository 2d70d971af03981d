"""Which obstacles stand in a vehicle's way: those that reach up to its lowest part."""

import math

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.polar import PolarView
from horizon_dl.ranging.vehicle_height import VehicleHeight

Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]


def in_the_way(
    obstacle: Mask,
    seen: Mask,
    contact: Rows,
    foot_seen: Mask,
    polar: PolarView,
    height_m: float | None,
    vehicle: VehicleHeight,
    margin_rad: float,
) -> Mask:
    """The obstacle cells (sectors, rows) of things that reach the vehicle's lowest part.

    Ground at the depression d lies h / tan d away, and what rises there to `below` under the camera is seen
    up to atan(below / h * tan d). A thing is in the way if cells of it, or of others that it touches in the
    picture, reach to there. Behind a low thing the limit stays that of its own, so that a second low thing
    is rather kept than passed over. Where the foot is not in view nothing is passed over, nor without a
    height, unless the camera's own height is asked for.

    Args:
        obstacle: the cells that look like obstacles.
        seen: the cells that say anything.
        contact: (sectors,) row of the first contact, -1 for none.
        foot_seen: (sectors,) ground is seen before the contact.
        polar: the frame's cells.
        height_m: of the camera over the floor.
        vehicle: how far it reaches down.
        margin_rad: this much lower is high enough: attitude and map are not exact.
    """
    height = height_m if height_m is not None and height_m > 0 else 0.0
    if vehicle.below_m > 0 and vehicle.below_m >= height:
        return obstacle
    foot = np.tan(np.clip((contact + 1) * polar.row_step_rad, 0.0, math.radians(89)))
    share = vehicle.below_m / height if height else 0.0
    limit_rad = np.arctan(share * foot) + margin_rad
    rows = np.round(limit_rad / polar.row_step_rad).astype(np.int64)
    if vehicle.below_m > 0:
        rows[(contact >= 0) & ~foot_seen] = polar.rows
    return connected_to_top(obstacle, seen, rows)


def connected_to_top(obstacle: Mask, seen: Mask, top_rows: Rows) -> Mask:
    """The obstacle cells from which a path over obstacle cells leads into the uppermost rows, or out of view.

    Cells that say nothing may be crossed upwards, but count as no obstacle themselves. What ends at the
    picture's upper rim may go on above it.

    Args:
        obstacle: (sectors, rows).
        seen: (sectors, rows).
        top_rows: (sectors,) how many rows are high enough; one at least is.
    """
    passable = obstacle | ~seen
    high = np.arange(obstacle.shape[1]) < np.maximum(1, top_rows)[:, None]
    cut_off: Mask = np.cumsum(seen, axis=1) - seen == 0  # nothing is seen above
    reached = obstacle & (high | cut_off)
    while True:
        grown = reached.copy()
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        sideways = grown & obstacle
        grown[1:] |= sideways[:-1]
        grown[:-1] |= sideways[1:]
        grown &= passable
        if np.array_equal(grown, reached):
            return reached & obstacle
        reached = grown
