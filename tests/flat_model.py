"""A model without a net: floor below the horizon, nothing on it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.rays import camera_rays


class FlatModel:
    """Sees free floor everywhere."""

    threshold = 0.5

    def __init__(self, camera: Camera) -> None:
        self.camera = camera

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Any:
        assert up_cam is not None
        above = elevation(camera_rays(self.camera).directions, up_cam)
        return SimpleNamespace(p_above=np.where(above > 0, 0.9, 0.03).astype(np.float32), elevation=above)
