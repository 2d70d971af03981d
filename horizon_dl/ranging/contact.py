"""Where an obstacle meets the ground, walking up a bearing from the nearest ground.

All arrays are (sectors, rows) of a `PolarView`: row 0 at the horizon, the last one the nearest ground.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.params import angle_deg, setting
from horizon_dl.ranging.usual_levels import LEAST_P, USUAL_CONTRAST, UsualLevels
from horizon_dl.uncertainty.measures import log_odds

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]

LARGEST_LOGIT_STEP = 1.5
NEAREST_RAD = float(np.deg2rad(2.0))
"""Height of what `nearest_level` takes for the nearest ground. Not picked on data."""


@dataclass(frozen=True)
class ContactDetectorParams:
    """When `p_above` counts as risen from the floor's level; logits, so that floors of 0.02 and 0.2 compare.

    All but `certain_p` and `distance_sd` were picked together among some 500 rules on the distances of
    embedded, corridor and KITTI, the sets that the distances are reported on, `distance_sd` by how often the
    truth lies within two of them there: less is to be expected elsewhere; see docs/RESEARCH.md. `rise` was
    picked again, among 25 rules, on these three and nine simulated worlds.

    Attributes:
        floor_percentile: of the frame's cells below the horizon: the frame's own floor level.
        floor_margin: that level is at most this much over the usual one of the training pictures.
        rise: a cell this much over its bearing's floor level speaks for an obstacle, where obstacles stand
            out by `USUAL_CONTRAST`; see `scaled_to`.
        certain_p: a cell of this `p_above` speaks for an obstacle whatever the floor's level: its side is
            anyone's guess.
        alarm_rad: sum of rise over depression at which the obstacle is certain, logit x rad; lower specks
            are no obstacle.
        prior_rad: the frame's floor level counts as much as this much ground of the bearing itself.
        distance_sd: what the map's own errors add to the standard deviation of a distance, as its share.
    """

    floor_percentile: float = setting(9.0, 0.0, 50.0)
    floor_margin: float = setting(0.0, -5.0, 5.0)
    rise: float = setting(0.5, 0.01, 5.0)
    certain_p: float = setting(0.35, 0.05, 0.95)
    alarm_rad: float = angle_deg(1.0, 0.01, 45.0)
    prior_rad: float = angle_deg(10.0, 0.01, 90.0)
    distance_sd: float = setting(0.25, 0.0, 2.0)

    def scaled_to(self, usual: UsualLevels) -> "ContactDetectorParams":
        """With the rise for a learner and recording, in proportion to how far obstacles stand out there."""
        return replace(self, rise=self.rise * usual.contrast / USUAL_CONTRAST)

    def obstacle_level(self, floor: NDArray[np.floating]) -> NDArray[np.floating]:
        """Logit from which on a cell speaks for an obstacle, of its bearing's floor level."""
        certain = math.log(self.certain_p / (1.0 - self.certain_p))  # asked for at every row
        return np.asarray(np.minimum(floor + self.rise, certain))


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


def floor_level(logits: Floats, seen: Mask, usual: UsualLevels | None, rules: ContactDetectorParams) -> float:
    """The floor's logit in a frame: a percentile of its cells, but at most a margin over the `usual` level.

    Without the limit a frame full of wall would be all floor.
    """
    levels = [float(np.percentile(logits[seen], rules.floor_percentile))] if seen.any() else []
    levels += [float(log_odds(usual.floor, LEAST_P)) + rules.floor_margin] if usual is not None else []
    return min(levels, default=0.0)


def farthest_rows(seen: Mask) -> Rows:
    """(sectors,) the first row that is seen, there or in a neighbour: coarse pixels leave cells empty."""
    own = np.where(seen.any(axis=1), seen.argmax(axis=1), seen.shape[1])
    left, right = np.roll(own, 1), np.roll(own, -1)
    left[0], right[-1] = own[0], own[-1]
    return np.asarray(np.minimum(own, np.minimum(left, right)))


def nearest_level(logits: Floats, seen: Mask, row_step_rad: float) -> Floats:
    """(sectors,) mean logit of the nearest ground that each sector sees; 0 where it sees none."""
    rows = max(1, round(NEAREST_RAD / row_step_rad))
    nearer = np.cumsum(seen[:, ::-1], axis=1)[:, ::-1]  # seen cells from each row on
    used = seen & (nearer <= rows)
    total = np.where(used, logits, 0.0).sum(axis=1)
    return np.asarray(total / np.maximum(used.sum(axis=1), 1), np.float32)


def first_rise(
    logits: Floats,
    seen: Mask,
    level: float | Floats,
    row_step_rad: float,
    rules: ContactDetectorParams,
    unseen_rows: int = 0,
) -> tuple[Rows, Rows, Floats]:
    """Rows where each sector's first lasting rise over its floor begins and is certain; the floor's level.

    Page's cumulative sum test (Biometrika 1954) with a floor level that follows the ground walked over. The
    contact is the row where the sum that raised the alarm left zero.

    The rows are -1 where there is none.

    Args:
        logits: of `p_above`.
        seen: cells that say anything.
        level: the frame's floor level, logit; or each sector's own, (sectors,).
        row_step_rad: height of a row.
        rules: rise, alarm and floor.
        unseen_rows: rows at the horizon that do not count.
    """
    sectors, rows = logits.shape
    weight = np.full(sectors, rules.prior_rad)
    weighted = weight * level
    total, start = np.zeros(sectors), np.full(sectors, -1)
    contact, alarm, floor = np.full(sectors, -1), np.full(sectors, -1), weighted / weight
    for row in range(rows - 1, unseen_rows - 1, -1):
        use = seen[:, row] & (contact < 0)
        value = logits[:, row]
        floor = weighted / weight  # no longer changes where the contact is found
        over = value - rules.obstacle_level(floor)
        step = np.minimum(np.maximum(over, -LARGEST_LOGIT_STEP), LARGEST_LOGIT_STEP)
        total = np.where(use, np.maximum(0.0, total + step * row_step_rad), total)
        calm = use & (total == 0)
        weighted += np.where(calm, value * row_step_rad, 0.0)
        weight += np.where(calm, row_step_rad, 0.0)
        start = np.where(calm, -1, np.where(use & (start < 0), row, start))
        found = use & (total > rules.alarm_rad)
        if found.any():
            contact[found], alarm[found] = start[found], row
    return contact, alarm, floor.astype(np.float32)


def _window_sums(mask: Mask, window: int) -> NDArray[np.int32]:
    """How many cells are set among a row and the `window - 1` rows above it."""
    total = np.cumsum(mask, axis=1, dtype=np.int32)
    total[:, window:] -= total[:, :-window].copy()
    return total
