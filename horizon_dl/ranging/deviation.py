"""How sure a distance is: standard deviations towards the camera and away from it.

The geometry's part are the derivatives of `height / tan(depression)`.
"""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.polar import PolarView
from horizon_dl.ranging.contact import ContactDetectorParams, farthest_rows, first_rise, nearest_level
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import FreeDistances, Outcome

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]


def distance_sd(
    distance_m: NDArray[np.floating],
    height_m: float,
    contact_sd_rad: NDArray[np.floating],
    rules: RangingParams,
) -> NDArray[np.float64]:
    """Standard deviation of `height / tan(depression)`, m.

    The derivative by the depression is `-(distance^2 + height^2) / height`.

    Args:
        distance_m: (N,).
        height_m: of the camera.
        contact_sd_rad: (N,) of the contact in the image: pixel size and the map's doubt.
        rules: the attitude's and the height's part.
    """
    slope = (np.square(distance_m, dtype=np.float64) + height_m**2) / height_m
    angle_sd = np.hypot(contact_sd_rad, rules.attitude_sd_rad)
    return np.asarray(np.hypot(slope * angle_sd, distance_m * rules.height_sd))


def sd_beyond(
    found: FreeDistances,
    logits: Floats,
    seen: Mask,
    level: float,
    polar: PolarView,
    rules: ContactDetectorParams,
    unseen: int,
) -> Floats:
    """Standard deviation away from the camera, m (sectors,).

    Where all ground in view is taken for an obstacle, a net may only doubt it. Then two deviations reach the
    contact that is found if the nearest ground is floor; where none is found so, the farthest ground in view.

    Args:
        found: with the deviation towards the camera.
        logits: (sectors, rows) of `p_above`.
        seen: cells that say anything.
        level: the frame's floor level, logit.
        polar: the frame's cells.
        rules: by which the contacts were found.
        unseen: rows at the horizon that do not count.
    """
    covered = (found.outcome == Outcome.OBSTACLE) & ~found.contact_seen & np.isfinite(found.distance_m)
    sd_m = found.sd_m.copy()
    if not covered.any():
        return sd_m
    own, known = logits[covered], seen[covered]
    levels = np.maximum(nearest_level(own, known, polar.row_step_rad), level)
    contact, _, _ = first_rise(own, known, levels, polar.row_step_rad, rules, unseen)
    farthest = np.maximum(farthest_rows(seen)[covered], max(unseen, 1))
    depression = np.where(contact >= 0, contact + 1, farthest) * polar.row_step_rad
    there_m = found.distance_m[covered] * np.tan(found.depression_rad[covered]) / np.tan(depression)
    beyond_m = np.maximum(there_m - found.distance_m[covered], 0.0)
    sd_m[covered] = np.hypot(sd_m[covered], beyond_m / 2)
    return sd_m
