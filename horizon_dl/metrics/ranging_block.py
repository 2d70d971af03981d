"""The block `ranging` of `metrics.json`, gathered while a comparison runs."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, FrameHeader
from horizon_dl.metrics.metric import State, joined_states, part_of
from horizon_dl.metrics.range_truth import level_ranges, true_obstacles
from horizon_dl.metrics.ranging import RangingAccumulator
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.usual_levels import UsualLevels
from horizon_dl.ranging.vehicle_height import CAMERA_ALONE, VehicleHeight

INDOORS_M = (0.7, 4.0)
ON_THE_ROAD_M = (5.0, 25.0)


class RangingBlock:
    """Accumulators over the frames with a range image: all obstacles of a learner, those connected to the
    horizon, and the truth's own floor in front of them, which shows what ranging itself gets wrong; for a
    vehicle of known height also what is in its way, against what was measured at its height.

    Distances count from 0.7 to 4 m, those of a car (its floor has a normal of its own) from 5 to 25 m.

    Args:
        headers: of the frames, where they are known beforehand.
        rules: of the ranging.
        vehicle: how far it reaches below and above the camera.

    Attributes:
        accumulators: `everything`, `connected`, `true_floor`, and `vehicle` where there is one.

    Example:
        >>> block = RangingBlock(recording.headers)                    # doctest: +SKIP
        >>> block.update(frame, p_above, usual)                 # doctest: +SKIP
        >>> metrics["ranging"] = block.compute()               # doctest: +SKIP
    """

    def __init__(
        self,
        headers: Sequence[FrameHeader] = (),
        rules: RangingParams | None = None,
        vehicle: VehicleHeight | None = None,
    ) -> None:
        on_the_road = any(header.floor_up_cam is not None for header in headers)
        near_m, far_m = ON_THE_ROAD_M if on_the_road else INDOORS_M
        rules = rules or RangingParams()
        self.accumulators = {
            "everything": RangingAccumulator(near_m, far_m, rules=rules),
            "connected": RangingAccumulator(near_m, far_m, CAMERA_ALONE, rules=rules),
            "true_floor": RangingAccumulator(near_m, far_m, rules=rules),
        }
        if vehicle is not None:
            self.accumulators["vehicle"] = RangingAccumulator(near_m, far_m, vehicle, True, rules=rules)

    def update(self, frame: Frame, p_above: NDArray[np.float32], usual: UsualLevels) -> None:
        """Count one frame; those without range, truth, attitude or height are left out.

        Args:
            frame: of the recording.
            p_above: (h, w) a learner's, at any size of the frame's aspect.
            usual: what the learner usually says of floor and obstacles.
        """
        range_m = level_ranges(frame)
        if range_m is None or frame.truth is None:
            return
        for name, accumulator in self.accumulators.items():
            if name != "true_floor":
                accumulator.update(frame, p_above, range_m, usual=usual)
        if frame.up_cam is not None:
            true_floor = self.accumulators["true_floor"]
            not_free, known = true_obstacles(frame, range_m, true_floor.bearings)
            true_floor.update(frame, not_free, range_m, known=known)

    def merge(self, other: "RangingBlock") -> None:
        """See `Metric`."""
        for name, accumulator in self.accumulators.items():
            accumulator.merge(other.accumulators[name])

    def state(self) -> State:
        """See `Metric`."""
        return joined_states(self.accumulators)

    def load(self, state: State) -> None:
        """See `Metric`; of a block of the same recording."""
        for name, accumulator in self.accumulators.items():
            accumulator.load(part_of(state, name))

    def compute(self) -> dict[str, Any]:
        """Of all obstacles, with the other blocks beside them; see `RangingAccumulator`."""
        blocks = {name: accumulator.compute() for name, accumulator in self.accumulators.items()}
        return {**blocks.pop("everything"), **blocks}
