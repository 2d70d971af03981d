"""From one picture and its attitude to sectors: the model, ranging and the temporal filter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.evidence.judge import Judge, Judged
from horizon_dl.evidence.place import Place, usual_levels
from horizon_dl.evidence.reason import Reason
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.polar import Bearings, bearings_for, polar_view
from horizon_dl.ranging.free_distance import free_distances_from_p
from horizon_dl.ranging.sectors import FreeDistances, no_distances
from horizon_dl.ranging.temporal_filter import SectorFilter
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.vehicle.flight_params import FlightParams


class FrameModel(Protocol):
    """What is needed of a model; `ObstacleModel` has it."""

    camera: Camera
    threshold: float
    place: Place | None
    rules: FlightRules

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Any:
        """An object with `p_above` and `elevation`, (h, w) each."""


def model_rays(model: FrameModel) -> NDArray[np.float32]:
    """(h, w, 3) unit rays of a model's working size, optical frame, NaN where not valid.

    The rays are inside the model file. The elevation over each axis taken for "up" is the arc sine of that
    component, so three predictions give them without a lens model on board.
    """
    black = np.zeros((model.camera.height, model.camera.width, 3), np.uint8)
    parts = [np.sin(model.predict(black, axis).elevation) for axis in np.eye(3, dtype=np.float32)]
    rays = np.stack(parts, axis=-1)
    return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True), np.float32)


def forward_in_camera(mount_rpy_rad: Sequence[float]) -> NDArray[np.float64]:
    """(3,) the body's forward axis in the optical frame."""
    return np.asarray(OPTICAL_FROM_FRD @ rotation_from_rpy(*mount_rpy_rad).T @ [1.0, 0.0, 0.0])


@dataclass
class Perception:
    """Looks at one picture after the other.

    Attributes:
        model: the loaded model.
        rays: of `model_rays`.
        forward_cam: the body's forward axis in the optical frame.
        bearings: sectors, zero is the body's forward direction.
        filter: joins the last frames.
        judge: asks for the evidence of every frame.
        judged: the last frame, before the filter.
        ranged: the same before evidence was asked for.
        vehicle: leave out obstacles that do not reach up to it; None leaves out none.
    """

    model: FrameModel
    rays: NDArray[np.float32]
    forward_cam: NDArray[np.float64]
    bearings: Bearings
    filter: SectorFilter
    judge: Judge
    vehicle: VehicleHeight | None = None
    judged: Judged | None = None
    ranged: FreeDistances | None = None

    @classmethod
    def of(
        cls,
        model: FrameModel,
        mount_rpy_rad: Sequence[float],
        frames: int | None = None,
        flight: FlightParams | None = None,
    ) -> "Perception":
        """Everything that does not change during a flight.

        Args:
            model: whose rules are followed.
            mount_rpy_rad: of the camera in the body.
            frames: that the filter joins; left out: as `flight` says.
            flight: of the filter; left out: the model's.
        """
        rays, forward_cam = model_rays(model), forward_in_camera(mount_rpy_rad)
        judge = Judge(model.camera, model.place, model.rules.evidence)
        flight = flight or model.rules.flight
        joined = SectorFilter(frames or flight.filter_frames, flight.filter_age_s, flight.filter_gap_s)
        return cls(model, rays, forward_cam, bearings_for(rays, forward_cam), joined, judge)

    def unknown(self) -> FreeDistances:
        """What holds of a picture without attitude."""
        return no_distances(self.bearings.centres_rad)

    def look(
        self,
        time_s: float,
        image: NDArray[np.uint8],
        up_cam: NDArray[np.float64],
        yaw_rad: float,
        height_m: float | None,
        floor_up_cam: NDArray[np.float64] | None = None,
        doubts: tuple[Reason, ...] = (),
    ) -> FreeDistances:
        """Sectors of one picture, joined with those before.

        Args:
            time_s: of the picture.
            image: (H, W, 3) uint8 RGB of the model's camera.
            up_cam: (3,) unit, the world's up in the optical frame.
            yaw_rad: of the body; only differences between pictures count.
            height_m: of the camera over the floor, or None: bearings only.
            floor_up_cam: (3,) the floor's normal where it differs from `up_cam`.
            doubts: why the frame is not to be believed, known beforehand.
        """
        self.judged = self.ranged = None
        outputs = self.model.predict(image, up_cam)
        floor = up_cam if floor_up_cam is None else floor_up_cam
        try:
            polar = polar_view(self.rays, floor, self.forward_cam, self.bearings)
        except ValueError:  # the body points straight up or down: no bearing means anything
            return self.unknown()
        found = free_distances_from_p(
            outputs.p_above,
            polar,
            height_m,
            usual=usual_levels(self.model.place, self.model.threshold),
            vehicle=self.vehicle,
            rules=self.model.rules.ranging,
        )
        self.judge.follow(self.model.place, self.model.rules.evidence)  # a fresh file brings its own
        self.ranged = found
        self.judged = self.judge.judge(
            time_s, image, up_cam, outputs.p_above, outputs.elevation, found, polar, doubts=doubts
        )
        return self.filter.add(time_s, yaw_rad, self.judged.found)
