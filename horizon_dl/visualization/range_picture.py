"""One frame ranged, a heading chosen, and both drawn: what a map means for a vehicle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.evidence.judge import Judge
from horizon_dl.evidence.place import Place
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.polar import OPTICAL_AXIS, bearings_for, polar_view
from horizon_dl.ranging.free_distance import free_distances_from_p, no_distances, p_of_entropy
from horizon_dl.ranging.heading import free_heading
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.ranges import draw_ranges


@dataclass(frozen=True)
class Vehicle:
    """Half its width, how far a heading must be free, and what is far; m."""

    radius_m: float
    needed_m: float
    far_m: float


DRONE, CAR = Vehicle(0.3, 2.0, 10.0), Vehicle(1.0, 10.0, 30.0)


def range_picture(
    frame: Frame,
    directions: NDArray[np.float32],
    p_above: NDArray[np.float32],
    threshold: float,
    place: Place | None = None,
) -> Image | None:
    """Free ground, contacts and the free heading nearest to the optical axis; None without an attitude.

    By the same rule as in flight, and with the same evidence as far as one picture has it: what is drawn as
    free is what would be sent as free.

    Args:
        frame: without a height there are bearings, but no metres. Where its floor's normal is known, it is
            a car's.
        directions: (h, w, 3) unit rays, optical frame.
        p_above: (h, w) a learner's.
        threshold: the learner's entropy threshold, bits.
        place: limits for the evidence; without them (a net that was not calibrated, and is not flown) none
            is asked for.

    Returns:
        (h, w, 3) uint8 RGB; also None where the camera looks straight up or down.
    """
    up_cam = frame.floor_normal
    if frame.up_cam is None or up_cam is None:
        return None
    vehicle = DRONE if frame.floor_up_cam is None else CAR
    try:
        polar = polar_view(directions, up_cam, bearings=bearings_for(directions, OPTICAL_AXIS))
    except ValueError:
        return None
    found = free_distances_from_p(p_above, polar, frame.height_m, floor_p=p_of_entropy(threshold))
    reasons: tuple[str, ...] = ()
    if place is not None:
        judge = Judge(frame.calibrated, place)
        up = elevation(directions, frame.up_cam)
        judged = judge.judge_picture(frame.time_s, frame.image, p_above, up, found, polar)
        reasons = tuple(map(str, judged.reasons))
        found = no_distances(found.bearing_rad) if reasons else judged.found
    heading = free_heading(found, 0.0, vehicle.radius_m, vehicle.needed_m)
    return draw_ranges(frame.image, directions, up_cam, found, heading, far_m=vehicle.far_m, reasons=reasons)
