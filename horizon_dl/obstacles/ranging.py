"""Free distance per bearing: the paper's visual sonar.

On a flat floor the depression `a` of an obstacle's ground contact gives its distance, `height / tan(a)`.
Source: arXiv:1806.08007, section on obstacle distance; the error terms are that formula's derivatives.
"""

import math
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from horizon_dl.obstacles.polar import PolarView

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]


class Outcome(IntEnum):
    """What is known of a bearing."""

    UNKNOWN = 0  # outside the view, no ground visible, or no attitude
    FREE = 1  # free from the nearest visible ground to the horizon
    OBSTACLE = 2


@dataclass(frozen=True)
class RangingRules:
    """When a run of obstacle cells counts as an obstacle, and how sure its distance is.

    Attributes:
        extent_rad: height of the window in which obstacle cells must prevail; lower specks are no obstacle,
            lower gaps are bridged.
        share: share of the window's cells that must be obstacle.
        horizon_rad: a connected obstacle reaches to this close to the horizon.
        unseen_rad: this close to the horizon nothing is asked: there the attitude's error decides the side,
            and every map is unsure.
        attitude_sd_rad: standard deviation of roll and pitch.
        height_sd: relative standard deviation of the height.
    """

    extent_rad: float = math.radians(1.5)
    share: float = 0.6
    horizon_rad: float = math.radians(2.0)
    unseen_rad: float = math.radians(1.0)
    attitude_sd_rad: float = math.radians(0.5)
    height_sd: float = 0.03


@dataclass(frozen=True)
class FreeDistances:
    """What is known in each bearing; arrays (sectors,).

    Attributes:
        bearing_rad: middle of the sector, clockwise from straight ahead.
        outcome: of `Outcome`.
        distance_m: level distance from the camera to the obstacle's ground contact; inf where free; NaN where
            unknown, and for obstacles without a height.
        sd_m: its standard deviation; NaN where there is no finite distance.
        depression_rad: of the contact; 0 where free, NaN where unknown.
        contact_seen: False where the obstacle covers the nearest visible ground: it is at most that far away.
        nearest_rad: depression of the nearest ground that the camera sees; 0 outside of its view.
    """

    bearing_rad: Floats
    outcome: NDArray[np.uint8]
    distance_m: Floats
    sd_m: Floats
    depression_rad: Floats
    contact_seen: Mask
    nearest_rad: Floats


def free_distances(
    obstacle: Mask,
    polar: PolarView,
    height_m: float | None,
    *,
    known: Mask | None = None,
    connected_only: bool = False,
    rules: RangingRules | None = None,
) -> FreeDistances:
    """Walk up each bearing from the nearest visible ground to the first obstacle.

    Args:
        obstacle: (h, w), the obstacle map.
        polar: the same frame's cells.
        height_m: of the camera over the floor; None or not positive: bearings only, no metres.
        known: (h, w), pixels that say anything; all if left out.
        connected_only: leave out obstacles that do not reach the horizon (mats, paint).
        rules: thresholds and error sizes.

    Returns:
        One entry a sector. A walk that meets no obstacle ends `FREE`; a sector whose visible cells are fewer
        than the window is high is `UNKNOWN`.
    """
    rules = rules or RangingRules()
    seen = polar.pixels if known is None else polar.counts(known)
    obstacle_cells = (2 * polar.counts(obstacle if known is None else obstacle & known) >= seen) & (seen > 0)
    seen_cells = seen > 0
    if connected_only:
        obstacle_cells = connected_to_horizon(obstacle_cells, seen_cells, _rows(rules.horizon_rad, polar))
    unseen_rows = min(_rows(rules.unseen_rad, polar), polar.rows - 1)
    window = max(1, _rows(rules.extent_rad, polar))
    contact = first_contact(obstacle_cells, seen_cells, window, rules.share, unseen_rows)
    visible = _nearest_rows(seen_cells)
    outcome = np.where(contact >= 0, Outcome.OBSTACLE, Outcome.FREE).astype(np.uint8)
    outcome[visible < window + unseen_rows] = Outcome.UNKNOWN
    doubt = _doubtful_rows(obstacle_cells, seen_cells, contact, window)
    gap = _rows_to_ground(seen_cells, contact)
    edge = np.where(contact < visible - 1, contact + (1 + gap) / 2, contact + 1)
    found = _in_metres(polar, outcome, edge, doubt + gap / 2, height_m, rules)
    return replace(found, contact_seen=found.contact_seen & (contact < visible - 1))


def no_distances(bearing_rad: Floats) -> FreeDistances:
    """`UNKNOWN` everywhere: what holds without an attitude or a picture."""
    nothing = np.full(len(bearing_rad), np.nan, np.float32)
    outcome = np.full(len(bearing_rad), Outcome.UNKNOWN, np.uint8)
    unseen = np.zeros(len(bearing_rad), np.bool_)
    zero = np.zeros(len(bearing_rad), np.float32)
    return FreeDistances(bearing_rad, outcome, nothing, nothing, nothing, unseen, zero)


def first_contact(
    obstacle: Mask, seen: Mask, window: int, share: float, unseen_rows: int = 0
) -> NDArray[np.int64]:
    """Row of the first obstacle of each sector from the nearest ground (the last row) up, -1 for none.

    Args:
        obstacle: (sectors, rows), row 0 at the horizon.
        seen: (sectors, rows), cells that say anything; the others neither confirm nor contradict.
        window: rows in which obstacle cells must have at least `share` of the seen ones.
        share: in (0, 1].
        unseen_rows: rows at the horizon that do not count.
    """
    rows = obstacle.shape[1]
    counted = np.arange(rows) >= unseen_rows
    found = _window_sums(obstacle & counted, window)
    of = _window_sums(seen & counted, window)
    # The window of row r holds r and the rows above it; an obstacle cell of its own starts it.
    starts = obstacle & counted & (found >= share * of) & (found > 0)
    # At the horizon the window is cut off: half of it must be left.
    starts &= np.arange(rows) >= unseen_rows + window // 2
    last = rows - 1 - np.argmax(starts[:, ::-1], axis=1)
    return np.where(starts.any(axis=1), last, -1)


def connected_to_horizon(obstacle: Mask, seen: Mask, horizon_rows: int) -> Mask:
    """The obstacle cells (sectors, rows) from which a path over obstacle cells leads to the horizon.

    Cells that say nothing may be crossed upwards, but count as no obstacle themselves.
    """
    passable = obstacle | ~seen
    reached = passable.copy()
    reached[:, max(1, horizon_rows) :] = False
    reached[:, : max(1, horizon_rows)] &= obstacle[:, : max(1, horizon_rows)]
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


def _rows(angle_rad: float, polar: PolarView) -> int:
    return round(angle_rad / polar.row_step_rad)


def _window_sums(mask: Mask, window: int) -> NDArray[np.int32]:
    """(sectors, rows) how many cells are set among a row and the `window - 1` rows above it."""
    total = np.cumsum(mask, axis=1, dtype=np.int32)
    total[:, window:] -= total[:, :-window].copy()
    return total


def _nearest_rows(seen: Mask) -> NDArray[np.int64]:
    """(sectors,) one more than the last row that is seen, 0 for none."""
    return np.asarray(np.where(seen, np.arange(1, seen.shape[1] + 1), 0).max(axis=1))


def _rows_to_ground(seen: Mask, contact: NDArray[np.int64]) -> NDArray[np.int64]:
    """(sectors,) rows from the contact's down to the next one that is seen; 1 in a map without gaps."""
    rows = np.arange(seen.shape[1])
    below = seen & (rows > contact[:, None])
    return np.where(below.any(axis=1), below.argmax(axis=1) - contact, 1)


def _doubtful_rows(
    obstacle: Mask, seen: Mask, contact: NDArray[np.int64], window: int
) -> NDArray[np.float32]:
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
    rules: RangingRules,
) -> FreeDistances:
    met = outcome == Outcome.OBSTACLE
    depression = np.where(met, edge_rows * polar.row_step_rad, np.nan)
    height = height_m if height_m is not None and height_m > 0 else math.nan
    distance = height / np.tan(depression)
    sd = distance_sd(distance, height, polar.row_step_rad * (0.5 + doubtful_rows), rules)
    free = outcome == Outcome.FREE
    return FreeDistances(
        polar.bearings.centres_rad,
        outcome,
        np.where(free, np.inf, distance).astype(np.float32),
        sd.astype(np.float32),
        np.where(free, 0.0, depression).astype(np.float32),
        met,
        (_nearest_rows(polar.pixels > 0) * polar.row_step_rad).astype(np.float32),
    )


def distance_sd(
    distance_m: NDArray[np.floating],
    height_m: float,
    contact_sd_rad: NDArray[np.floating],
    rules: RangingRules,
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
