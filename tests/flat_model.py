"""A model without a net: floor below the horizon, nothing on it."""

from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.evidence.appearance import FEATURES
from horizon_dl.evidence.judge import Judge, Judged
from horizon_dl.evidence.place import LEVELS, Place
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.ranging.sectors import FreeDistances, no_distances
from horizon_dl.runtime.rules import FlightRules

ANY_PLACE = Place(
    (-1e3,) * len(FEATURES),
    (1e3,) * len(FEATURES),
    np.ones((LEVELS,) * 3, np.bool_),
    frames=1,
    horizon_accuracy=1.0,
)
"""Where every picture is familiar."""


class FlatModel:
    """Sees free floor everywhere."""

    card: ClassVar[dict[str, Any]] = {}

    threshold = 0.5
    place: Place | None = ANY_PLACE
    rules = FlightRules()

    def __init__(self, camera: Camera) -> None:
        self.camera = camera

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Any:
        assert up_cam is not None
        above = elevation(camera_rays(self.camera).directions, up_cam)
        return SimpleNamespace(p_above=np.where(above > 0, 0.9, 0.03).astype(np.float32), elevation=above)


class TrustingJudge(Judge):
    """Believes every frame: for tests of the loop whose models look at no picture."""

    def judge(self, time_s: float, *arguments: Any, doubts: tuple[Any, ...] = ()) -> Judged:
        found: FreeDistances = arguments[4]
        self.frames["believed"] += 1
        return Judged(no_distances(found.bearing_rad) if doubts else found, doubts)
