"""Where an obstacle meets the ground, walking up a bearing from the nearest ground.

All arrays are (sectors, rows) of a `PolarView`: row 0 at the horizon, the last one the nearest ground.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]

LARGEST_LOGIT_STEP = 1.5


@dataclass(frozen=True)
class RiseRules:
    """When `p_above` counts as risen from the floor's level; logits, so that floors of 0.02 and 0.2 compare.

    Attributes:
        floor_percentile: of the frame's cells below the horizon: the frame's own floor level.
        rise: a cell this much over its bearing's floor level speaks for an obstacle,
        noise: plus this often the standard deviation of the noise between neighbouring cells.
        alarm_rad: sum of rise over depression at which the obstacle is certain, logit x rad; lower specks
            are no obstacle.
        prior_rad: the frame's floor level counts as much as this much ground of the bearing itself.
        swing: a bearing's floor may lie this much over the frame's floor level, and 3 times below it.
        knee_rad: the knee is looked for from this much above the alarm to this much below the first rise.
        knee_factor: the knee is at most this many times farther away than the first rise.
    """

    floor_percentile: float = 9.0
    rise: float = 0.7
    noise: float = 1.5
    alarm_rad: float = math.radians(1.0)
    prior_rad: float = math.radians(3.0)
    swing: float = 0.5
    knee_rad: float = math.radians(1.0)
    knee_factor: float = 1.25


def first_contact(obstacle: Mask, seen: Mask, window: int, share: float, unseen_rows: int = 0) -> Rows:
    """Row of the first obstacle of each sector of an obstacle map, -1 for none.

    Args:
        obstacle: obstacle cells.
        seen: cells that say anything; the others neither confirm nor contradict.
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


def floor_level(logit: Floats, seen: Mask, usual: float | None, rules: RiseRules) -> float:
    """The floor's logit in a frame: a percentile of its cells, but at most the `usual` level of training.

    Without the limit a frame full of wall would be all floor.
    """
    own = float(np.percentile(logit[seen], rules.floor_percentile)) if seen.any() else -math.inf
    level = min(own, math.inf if usual is None else usual)
    return level if math.isfinite(level) else 0.0


def needed_rise(logit: Floats, seen: Mask, rules: RiseRules) -> float:
    """The rise over the floor that speaks for an obstacle in this frame, logit.

    The noise is taken from the median absolute difference of neighbouring rows: edges do not move it.
    """
    steps = np.abs(np.diff(logit, axis=1))[seen[:, 1:] & seen[:, :-1]]
    sd = float(np.median(steps)) / (0.6745 * math.sqrt(2)) if steps.size else 0.0
    return rules.rise + rules.noise * sd


def first_rise(
    logit: Floats,
    seen: Mask,
    level: float,
    rise: float,
    row_step_rad: float,
    rules: RiseRules,
    unseen_rows: int = 0,
) -> tuple[Rows, Rows, Floats]:
    """Rows where each sector's first lasting rise over its floor begins and is certain; the floor's level.

    Page's cumulative sum test (Biometrika 1954) with a floor level that follows the ground walked over. The
    contact is the row where the sum that raised the alarm left zero.

    The rows are -1 where there is none.

    Args:
        logit: of `p_above`.
        seen: cells that say anything.
        level: the frame's floor level, logit.
        rise: see `needed_rise`.
        row_step_rad: height of a row.
        rules: alarm and floor.
        unseen_rows: rows at the horizon that do not count.
    """
    sectors, rows = logit.shape
    weight = np.full(sectors, rules.prior_rad)
    weighted = weight * level
    total, start = np.zeros(sectors), np.full(sectors, -1)
    contact, alarm, floor = np.full(sectors, -1), np.full(sectors, -1), np.full(sectors, level)
    for row in range(rows - 1, unseen_rows - 1, -1):
        use = seen[:, row] & (contact < 0)
        value = logit[:, row]
        floor = np.where(
            contact < 0, np.clip(weighted / weight, level - 3 * rules.swing, level + rules.swing), floor
        )
        step = np.clip(value - floor - rise, -LARGEST_LOGIT_STEP, LARGEST_LOGIT_STEP)
        total = np.where(use, np.maximum(0.0, total + step * row_step_rad), total)
        calm = use & (total == 0)
        start = np.where(calm, -1, np.where(use & (start < 0), row, start))
        weighted = weighted + np.where(calm, value * row_step_rad, 0.0)
        weight = weight + np.where(calm, row_step_rad, 0.0)
        found = use & (total > rules.alarm_rad)
        contact, alarm = np.where(found, start, contact), np.where(found, row, alarm)
    return contact, alarm, floor.astype(np.float32)


def knees(logit: Floats, seen: Mask, start: Rows, alarm: Rows, row_step_rad: float, rules: RiseRules) -> Rows:
    """The row of each sector where the rise really begins, at or above its `start`; -1 stays -1.

    The sum of `first_rise` leaves zero with the first noise in front of an obstacle. The contact is the knee
    of the broken line, level and then rising, that fits best (Hinkley, JASA 1971).

    Args:
        logit: of `p_above`.
        seen: cells that say anything.
        start: first rows of `first_rise`.
        alarm: its rows of certainty.
        row_step_rad: height of a row.
        rules: where the knee may lie.
    """
    rows, margin = np.arange(logit.shape[1]), round(rules.knee_rad / row_step_rad)
    last, first = (start + margin)[:, None], (alarm - margin)[:, None]
    window = (seen & (rows >= first) & (rows <= last)).astype(np.float64)
    rise = np.maximum(0.0, rows[:, None] + 0.5 - rows)  # of a line with its knee at each row
    count = np.maximum(window.sum(axis=1, keepdims=True), 1.0)
    value = window * (logit - (window * logit).sum(axis=1, keepdims=True) / count)
    spread = window @ np.square(rise).T - np.square(window @ rise.T) / count
    slope = value @ rise.T
    farthest = np.arctan(np.tan((start + 1) * row_step_rad) / rules.knee_factor) / row_step_rad - 1
    allowed = (window > 0) & (rows > first) & (rows < last) & (rows <= start[:, None]) & (slope > 0)
    gain = np.where(allowed & (spread > 1e-9), np.square(slope) / np.maximum(spread, 1e-9), 0.0)
    best = np.maximum(gain.argmax(axis=1), np.ceil(farthest).astype(np.int64))
    return np.where((start >= 0) & (gain.max(axis=1) > 0), np.minimum(best, start), start)


def connected_to_horizon(obstacle: Mask, seen: Mask, horizon_rows: int) -> Mask:
    """The obstacle cells from which a path over obstacle cells leads to the horizon.

    Cells that say nothing may be crossed upwards, but count as no obstacle themselves.
    """
    passable = obstacle | ~seen
    reached = obstacle.copy()
    reached[:, max(1, horizon_rows) :] = False
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


def _window_sums(mask: Mask, window: int) -> NDArray[np.int32]:
    """How many cells are set among a row and the `window - 1` rows above it."""
    total = np.cumsum(mask, axis=1, dtype=np.int32)
    total[:, window:] -= total[:, :-window].copy()
    return total
