"""One frame ranged and a heading chosen: what a map means for a vehicle."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.evidence.judge import Judge
from horizon_dl.evidence.place import Place, usual_levels
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.polar import OPTICAL_AXIS, bearings_for, polar_view
from horizon_dl.ranging.free_distance import free_distances_from_p
from horizon_dl.ranging.heading import Heading, free_heading
from horizon_dl.ranging.sectors import FreeDistances, Outcome, no_distances
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.rules import FlightRules

Vector = NDArray[np.float64] | tuple[float, float, float]


@dataclass(frozen=True)
class Vehicle:
    """Half its width, how far a heading must be free, and what is far; m."""

    radius_m: float
    needed_m: float
    far_m: float


DRONE, CAR = Vehicle(0.3, 2.0, 10.0), Vehicle(1.0, 10.0, 30.0)


@dataclass(frozen=True)
class Ranged:
    """What is known in each bearing of a frame, and where to go.

    Attributes:
        found: the sectors.
        heading: the free heading nearest to straight ahead; None if there is none.
        up_cam: (3,) the floor's normal in the optical frame.
        vehicle: whose heading.
        forward_cam: (3,) what bearing zero means.
        doubts: why the frame, or some of its sectors, are unknown.
        asked: whether evidence was asked for, as it is in flight.
    """

    found: FreeDistances
    heading: Heading | None
    up_cam: NDArray[np.float64]
    vehicle: Vehicle = DRONE
    forward_cam: Vector = OPTICAL_AXIS
    doubts: tuple[str, ...] = ()
    asked: bool = True

    @property
    def has_metres(self) -> bool:
        """Whether there are distances, not bearings alone."""
        return bool(np.isfinite(self.found.distance_m).any())

    def nearest(self) -> tuple[float, float] | None:
        """Metres and bearing (rad) of the nearest obstacle; None where none has a distance."""
        met = (self.found.outcome == Outcome.OBSTACLE) & np.isfinite(self.found.distance_m)
        if not met.any():
            return None
        index = int(np.argmin(np.where(met, self.found.distance_m, np.inf)))
        return float(self.found.distance_m[index]), float(self.found.bearing_rad[index])


def range_frame(
    frame: Frame,
    directions: NDArray[np.float32],
    p_above: NDArray[np.float32],
    threshold: float,
    place: Place | None = None,
    rules: FlightRules | None = None,
    height: VehicleHeight | None = None,
) -> Ranged | None:
    """Distances per bearing, and the free heading nearest to the optical axis; None without an attitude.

    By the rule of the flight and, where there are limits for it, with its evidence as far as one picture
    has it: what is drawn as free is what would be sent as free.

    Args:
        frame: without a height there are bearings, but no metres. Where its floor's normal is known, it is
            a car's.
        directions: (h, w, 3) unit rays, optical frame.
        p_above: (h, w) a learner's.
        threshold: the learner's entropy threshold, bits.
        place: limits for the evidence; None asks for none, as for nets that are not flown.
        rules: of ranging and evidence; the defaults if left out.
        height: leave out obstacles that do not reach up to the vehicle; None leaves out none.

    Returns:
        None also where the camera looks straight up or down.
    """
    up_cam = frame.floor_normal
    if frame.up_cam is None or up_cam is None or not np.isfinite(up_cam).all():
        return None
    try:
        polar = polar_view(directions, up_cam, bearings=bearings_for(directions, OPTICAL_AXIS))
    except ValueError:
        return None
    rules = rules or FlightRules()
    usual = usual_levels(place, threshold)
    found = free_distances_from_p(
        p_above, polar, frame.height_m, usual=usual, vehicle=height, rules=rules.ranging
    )
    doubts: tuple[str, ...] = ()
    if place is not None:
        up = elevation(directions, frame.up_cam)
        judge = Judge(frame.calibrated, place, rules.evidence)
        judged = judge.judge_picture(frame.time_s, frame.image, p_above, up, found, polar)
        found = no_distances(found.bearing_rad) if judged.reasons else judged.found
        doubts = judged.doubts
    vehicle = DRONE if frame.floor_up_cam is None else CAR
    return replace(ranged(found, up_cam, vehicle), doubts=doubts, asked=place is not None)


def ranged(
    found: FreeDistances,
    up_cam: NDArray[np.float64],
    vehicle: Vehicle = DRONE,
    forward_cam: Vector = OPTICAL_AXIS,
) -> Ranged:
    """Sectors with the heading that they leave to a vehicle."""
    heading = free_heading(found, 0.0, vehicle.radius_m, vehicle.needed_m)
    return Ranged(found, heading, up_cam, vehicle, forward_cam)


def ranges_of(frame: Frame, prediction: Prediction, height: VehicleHeight | None = None) -> Ranged | None:
    """`range_frame` of a prediction; None without camera or attitude."""
    if prediction.directions is None or not prediction.has_attitude:
        return None
    return range_frame(
        frame,
        prediction.directions,
        prediction.measures.p_above,
        prediction.threshold,
        prediction.place,
        prediction.rules,
        height,
    )
