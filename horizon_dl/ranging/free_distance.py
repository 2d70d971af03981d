"""Free distance per bearing: the paper's visual sonar.

On a flat floor the depression `a` of an obstacle's ground contact gives its distance, `height / tan(a)`.
Source: arXiv:1806.08007, section on obstacle distance.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.polar import PolarView
from horizon_dl.ranging.contact import Rows, farthest_rows, first_contact, first_rise, floor_level
from horizon_dl.ranging.deviation import distance_sd, sd_beyond
from horizon_dl.ranging.in_the_way import in_the_way
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.ranging.usual_levels import LEAST_P, UsualLevels
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.uncertainty.measures import log_odds

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]


def free_distances(
    obstacle: Mask,
    polar: PolarView,
    height_m: float | None,
    *,
    known: Mask | None = None,
    vehicle: VehicleHeight | None = None,
    rules: RangingParams | None = None,
) -> FreeDistances:
    """Walk up each bearing from the nearest visible ground to the first obstacle.

    Args:
        obstacle: (h, w), the obstacle map.
        polar: the same frame's cells.
        height_m: of the camera over the floor; None or not positive: bearings only, no metres.
        known: (h, w), pixels that say anything; all if left out.
        vehicle: leave out obstacles that do not reach up to it (mats, paint); None leaves out none.
        rules: thresholds and error sizes.

    Returns:
        One entry a sector. A walk that meets no obstacle ends `FREE`; a sector whose visible cells are fewer
        than the window is high is `UNKNOWN`.
    """
    rules = rules or RangingParams()
    pixels = polar.pixels if known is None else polar.counts(known)
    seen = pixels > 0
    covered = polar.counts(obstacle if known is None else obstacle & known)
    cells = seen & (covered >= rules.cell_share * pixels)
    window, unseen = _window_and_unseen(polar, rules)
    contact = first_contact(cells, seen, window, rules.share, unseen)
    if vehicle is not None:
        foot_seen = _foot_seen(seen, contact, window)
        cells = in_the_way(cells, seen, contact, foot_seen, polar, height_m, vehicle, rules.horizon_rad)
        contact = first_contact(cells, seen, window, rules.share, unseen)
    return _from_contacts(polar, seen, cells, contact, height_m, rules)


def free_distances_from_p(
    p_above: Floats,
    polar: PolarView,
    height_m: float | None,
    *,
    usual: UsualLevels | None = None,
    vehicle: VehicleHeight | None = None,
    rules: RangingParams | None = None,
    beyond: bool = False,
) -> FreeDistances:
    """The same from `p_above` itself: the contact is where it rises from the floor's level.

    One threshold for all frames does not serve: the floor's level differs between frames and bearings by as
    much as it rises at an obstacle's foot.

    Args:
        p_above: (h, w) in [0, 1], NaN where nothing is said.
        polar: the same frame's cells.
        height_m: see `free_distances`.
        usual: what the learner usually says of floor and obstacles (`evidence.place.usual_levels`); without
            it a frame full of wall passes for floor.
        vehicle: see `free_distances`.
        rules: see `free_distances`.
        beyond: also ask how much farther an obstacle may be whose contact is not seen: a second walk, which a
            flight has no use for.
    """
    rules = rules or RangingParams()
    rise = rules.rise if usual is None else rules.rise.scaled_to(usual)
    mean, seen = polar.means(p_above)
    logits = log_odds(mean, LEAST_P)
    window, unseen = _window_and_unseen(polar, rules)
    level = floor_level(logits[:, unseen:], seen[:, unseen:], usual, rise)
    contact, alarm, floor = first_rise(logits, seen, level, polar.row_step_rad, rise, unseen)
    cells = seen & (logits > rise.obstacle_level(floor)[:, None])
    if vehicle is not None:
        foot_seen = _foot_seen(seen, contact, window)
        cells = in_the_way(cells, seen, contact, foot_seen, polar, height_m, vehicle, rules.horizon_rad)
        logits = np.where(cells, logits, np.minimum(logits, floor[:, None]))
        contact, alarm, _ = first_rise(logits, seen, level, polar.row_step_rad, rise, unseen)
    # A slow rise leaves the contact in doubt by all its length.
    doubt = (contact - alarm).astype(np.float32)
    found = _from_contacts(polar, seen, cells, contact, height_m, rules, doubt)
    of_map = np.where(found.outcome == Outcome.OBSTACLE, rise.distance_sd * found.distance_m, 0.0)
    sd_m = np.hypot(found.sd_m, of_map).astype(np.float32)
    found = replace(found, sd_m=sd_m, sd_beyond_m=sd_m)
    if not beyond:
        return found
    return replace(found, sd_beyond_m=sd_beyond(found, logits, seen, level, polar, rise, unseen))


def _window_and_unseen(polar: PolarView, rules: RangingParams) -> tuple[int, int]:
    unseen = min(_rows(rules.unseen_rad, polar), polar.rows - 1)
    return max(1, _rows(rules.extent_rad, polar)), unseen


def _from_contacts(
    polar: PolarView,
    seen: Mask,
    cells: Mask,
    contact: Rows,
    height_m: float | None,
    rules: RangingParams,
    doubt: NDArray[np.floating] | float = 0.0,
) -> FreeDistances:
    window, unseen = _window_and_unseen(polar, rules)
    visible = _nearest_rows(seen)
    outcome = np.where(contact >= 0, Outcome.OBSTACLE, Outcome.FREE).astype(np.uint8)
    outcome[visible < window + unseen] = Outcome.UNKNOWN
    doubt = doubt + _doubtful_rows(cells, seen, contact, window)
    gap = _rows_to_ground(seen, contact)
    edge = np.where(contact < visible - 1, contact + (1 + gap) / 2, contact + 1)
    # Where the camera looks down, what stands behind the farthest ground in view was not looked at.
    farthest = farthest_rows(seen)
    edge = np.where(contact >= 0, edge, np.where(farthest > window + unseen, farthest, 0))
    found = _in_metres(polar, outcome, edge, doubt + gap / 2, height_m, rules)
    return replace(found, contact_seen=found.contact_seen & _foot_seen(seen, contact, window))


def _foot_seen(seen: Mask, contact: Rows, window: int) -> Mask:
    """(sectors,) whether ground is seen before the contact: half a window, less may be noise at the rim."""
    return np.asarray(contact < _nearest_rows(seen) - 1 - window // 2)


def _rows(angle_rad: float, polar: PolarView) -> int:
    return round(angle_rad / polar.row_step_rad)


def _nearest_rows(seen: Mask) -> Rows:
    """(sectors,) one more than the last row that is seen, 0 for none."""
    return np.asarray(np.where(seen, np.arange(1, seen.shape[1] + 1), 0).max(axis=1))


def _rows_to_ground(seen: Mask, contact: Rows) -> Rows:
    """(sectors,) rows from the contact's down to the next one that is seen; 1 in a map without gaps."""
    rows = np.arange(seen.shape[1])
    below = seen & (rows > contact[:, None])
    return np.where(below.any(axis=1), below.argmax(axis=1) - contact, 1)


def _doubtful_rows(obstacle: Mask, seen: Mask, contact: Rows, window: int) -> NDArray[np.float32]:
    """(sectors,) cells within a window of the contact that contradict it: obstacle below, floor above."""
    rows = np.arange(obstacle.shape[1])
    away = rows[None] - contact[:, None]
    below = obstacle & (away > 0) & (away <= window)
    above = ~obstacle & seen & (away <= 0) & (away > -window)
    return np.asarray((below | above).sum(axis=1), np.float32)


def _in_metres(
    polar: PolarView,
    outcome: NDArray[np.uint8],
    edge_rows: NDArray[np.floating],
    doubtful_rows: NDArray[np.floating],
    height_m: float | None,
    rules: RangingParams,
) -> FreeDistances:
    depression = np.where(outcome != Outcome.UNKNOWN, edge_rows * polar.row_step_rad, np.nan)
    to_horizon = depression == 0.0
    height = height_m if height_m is not None and height_m > 0 else math.nan
    distance = height / np.tan(np.where(to_horizon, np.nan, depression))
    sd = distance_sd(distance, height, polar.row_step_rad * (0.5 + doubtful_rows), rules)
    return FreeDistances(
        polar.bearings.centres_rad,
        outcome,
        np.where(to_horizon, np.inf, distance).astype(np.float32),
        sd.astype(np.float32),
        sd.astype(np.float32),
        depression.astype(np.float32),
        outcome == Outcome.OBSTACLE,
        (_nearest_rows(polar.pixels > 0) * polar.row_step_rad).astype(np.float32),
    )
