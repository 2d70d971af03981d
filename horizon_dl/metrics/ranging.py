"""Free distances against measured ones: the block `ranging` of `metrics.json`."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.geometry.polar import Bearings, polar_view
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.metrics.metric import State, loaded
from horizon_dl.metrics.range_truth import true_distances
from horizon_dl.ranging.free_distance import free_distances, free_distances_from_p
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.ranging.usual_levels import UsualLevels
from horizon_dl.ranging.vehicle_height import CAMERA_ALONE, VehicleHeight

Floats = NDArray[np.float32]

MISSED_FACTOR = 1.5
FALSE_STOP_FACTOR = 0.67
EVALUATION_BEARINGS = Bearings(120, math.radians(1.0))


@dataclass
class RangingAccumulator:
    """Errors of free distances over the bearings whose true distance lies in an interval.

    A contact below the image cannot be measured, but its obstacle must not be overlooked: such bearings count
    for `missed` (ground beyond the obstacle reported free) and not for the errors.

    Attributes:
        near_m: the interval's near end, m.
        far_m: its far end, m.
        vehicle: range the obstacles that reach up to it; None ranges all.
        truth_in_reach: let the truth be what is as high as the vehicle; else it is every obstacle.
        bearings: sectors, zero is the optical axis.
        rules: of the ranging.
        relative: errors of the measured bearings as shares of the true distance, frame by frame.
        contact_seen: whether the measured bearings' contacts were seen.
        within_2sd: whether they were within twice the standard deviation that is stated for their side.
        counts: bearings with a true distance; of them with a contact below the view, unknown, missed, and
            false stops.
    """

    near_m: float = 0.7
    far_m: float = 25.0
    vehicle: VehicleHeight | None = None
    truth_in_reach: bool = False
    bearings: Bearings = EVALUATION_BEARINGS
    rules: RangingParams = field(default_factory=RangingParams)
    relative: list[Floats] = field(default_factory=list)
    contact_seen: list[NDArray[np.bool_]] = field(default_factory=list)
    within_2sd: list[NDArray[np.bool_]] = field(default_factory=list)
    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(5, np.int64))

    def update(
        self,
        frame: Frame,
        found: NDArray[np.bool_] | Floats,
        range_m: Floats,
        *,
        known: NDArray[np.bool_] | None = None,
        usual: UsualLevels | None = None,
    ) -> FreeDistances | None:
        """Count one frame.

        Args:
            frame: with truth, attitude and height; others are left out (None is returned).
            found: (h, w) at any size of the frame's aspect: an obstacle map (bool) or `p_above` (float).
            range_m: (h', w') of `level_ranges`.
            known: (h, w) pixels of an obstacle map that say anything; all if left out.
            usual: for `p_above`, see `free_distances_from_p`.
        """
        up_cam = frame.floor_normal
        if up_cam is None or frame.height_m is None or frame.truth is None:
            return None
        truth_m = true_distances(frame, range_m, self.bearings, self.vehicle if self.truth_in_reach else None)
        height, width = found.shape
        directions = camera_rays(frame.calibrated.scaled(width, height)).directions
        polar = polar_view(directions, up_cam, bearings=self.bearings)
        height_m = frame.height_m
        options: dict[str, Any] = {"vehicle": self.vehicle, "rules": self.rules}
        if found.dtype == np.bool_:
            distances = free_distances(found.astype(np.bool_), polar, height_m, known=known, **options)
        else:
            p_above = found.astype(np.float32)
            distances = free_distances_from_p(p_above, polar, height_m, usual=usual, beyond=True, **options)
        self.count(distances, truth_m, height_m)
        return distances

    def count(self, found: FreeDistances, truth_m: Floats, height_m: float) -> None:
        """Count the bearings (sectors,) of one frame, its camera `height_m` over the floor."""
        with np.errstate(invalid="ignore"):
            used = (truth_m >= self.near_m) & (truth_m <= self.far_m)
        distance, truth = found.distance_m[used], truth_m[used]
        unknown = found.outcome[used] == Outcome.UNKNOWN
        met = found.outcome[used] == Outcome.OBSTACLE
        in_view = height_m / truth < np.tan(found.nearest_rad[used])
        covered = met & ~found.contact_seen[used]
        with np.errstate(invalid="ignore"):
            missed = ~unknown & (distance > MISSED_FACTOR * truth) & (in_view | ~covered)
            false_stop = met & (distance < FALSE_STOP_FACTOR * truth)
        self.counts += [len(truth), (~in_view).sum(), unknown.sum(), missed.sum(), false_stop.sum()]
        measured = met & in_view
        beyond = truth[measured] - distance[measured]
        sd_m = np.where(beyond > 0, found.sd_beyond_m[used][measured], found.sd_m[used][measured])
        self.relative.append((np.abs(beyond) / truth[measured]).astype(np.float32))
        self.contact_seen.append(found.contact_seen[used][measured])
        self.within_2sd.append(np.abs(beyond) <= 2 * sd_m)

    def merge(self, other: "RangingAccumulator") -> None:
        """See `Metric`; the other has the same interval."""
        self.relative += other.relative
        self.contact_seen += other.contact_seen
        self.within_2sd += other.within_2sd
        self.counts += other.counts

    def state(self) -> State:
        """See `Metric`."""
        return {
            "relative": joined(self.relative).astype(np.float32),
            "contact_seen": joined(self.contact_seen).astype(np.bool_),
            "within_2sd": joined(self.within_2sd).astype(np.bool_),
            "counts": self.counts.copy(),
        }

    def load(self, state: State) -> None:
        """See `Metric`."""
        self.relative, self.within_2sd = [state["relative"].copy()], [state["within_2sd"].copy()]
        self.contact_seen = [state["contact_seen"].copy()]
        self.counts = loaded(state["counts"], self.counts)

    def compute(self) -> dict[str, Any]:
        """The figures; None where there was nothing to measure.

        `columns` bearings had a true distance in the interval. Of them `missed` (share reported free beyond
        1.5 times the true distance), `false_stop` (share reported under 0.67 times), `unknown`, and
        `contact_below_view`; `median_relative_error` and `within_2sd` are over the others with a reported
        obstacle, `within_2sd_seen` over those of them whose contact was seen, a share `contact_seen`.
        """
        columns, *shares = (int(n) for n in self.counts)
        relative, within = joined(self.relative), joined(self.within_2sd)
        seen = joined(self.contact_seen).astype(np.bool_)
        names = ("contact_below_view", "unknown", "missed", "false_stop")
        return {
            "median_relative_error": float(np.median(relative)) if len(relative) else None,
            "columns": columns,
            **{name: n / columns if columns else None for name, n in zip(names, shares, strict=True)},
            "within_2sd": float(np.mean(within)) if len(within) else None,
            "within_2sd_seen": float(np.mean(within[seen])) if seen.any() else None,
            "contact_seen": float(np.mean(seen)) if len(seen) else None,
            "interval_m": [self.near_m, self.far_m],
            "connected_only": self.vehicle == CAMERA_ALONE,
            "vehicle_height_m": self.vehicle and [self.vehicle.below_m, self.vehicle.above_m],
        }


def joined(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """All parts end to end; an empty array of no parts."""
    return np.concatenate(parts) if parts else np.empty(0)
