"""A model file on a data set or on plain pictures, without torch."""

from dataclasses import asdict, replace
from math import isclose
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, has_attitude
from horizon_dl.data.source import FrameSource
from horizon_dl.data.view import View
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import area_resize, nearest
from horizon_dl.runtime.model import ObstacleModel, Outputs
from horizon_dl.runtime.perception import model_rays
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.uncertainty.measures import Measures


class FilePredictor:
    """An exported file as a `Predictor`.

    Example:
        >>> predictor = FilePredictor(ObstacleModel.load("model.onnx"))   # doctest: +SKIP
        >>> predictor.predict(frame).obstacles.mean()                     # doctest: +SKIP
    """

    def __init__(self, model: ObstacleModel, name: str = "model.onnx") -> None:
        self.model, self.name = model, name
        data = model.card.get("trained_on", {}).get("data")
        self.trained_on = str(data) if data else None
        self._rays = model_rays(model)

    def check(self, source: FrameSource) -> None:
        """InputError: the source has another camera than the model was exported for."""
        if source.camera is not None:
            check_camera(self.model, source.camera, source.name)

    def predict(self, frame: Frame) -> Prediction:
        """See `Predictor`; FrameError for an image of another size than the model takes."""
        model = self.model
        if frame.image.shape[:2] != (model.camera.height, model.camera.width):
            theirs = f"{frame.image.shape[1]}x{frame.image.shape[0]}"
            problem = f"is {theirs} pixels, the model takes {_size(model.camera)}"
            raise FrameError(frame.name, problem, "export for this size with `horizon-dl export RUN --size`")
        found = model.predict(frame.image, frame.up_cam if has_attitude(frame) else None)
        said = of_outputs(frame, found, model.threshold, self._rays)
        return replace(said, place=model.place, rules=model.rules)


def of_outputs(frame: Frame, found: Outputs, threshold: float, directions: NDArray[np.float32]) -> Prediction:
    """A model file's outputs as a prediction; the obstacle map is the file's own."""
    height, width = found.entropy.shape
    same = frame.image.shape[:2] == (height, width)
    view = View(frame.image if same else area_resize(frame.image, (width, height)), found.elevation)
    return Prediction(view, measures_of(found), threshold, small_obstacles(found), directions)


def measures_of(found: Outputs) -> Measures:
    """The measures among a model's outputs."""
    return Measures(
        found.p_above, found.entropy, found.expected_entropy, found.mutual_information, found.surprisal
    )


def small_obstacles(found: Outputs) -> NDArray[np.bool_]:
    """The obstacle map at the working size, which the model enlarged by repeating pixels."""
    return nearest(found.obstacles, *found.entropy.shape)


def check_camera(model: ObstacleModel, camera: Camera, where: str | Path) -> None:
    """InputError unless the camera, of a recording or a file, is the model's, whose rays are in it."""
    if same_camera(model.camera, camera):
        return
    ours, theirs = _size(model.camera), _size(camera)
    sizes = f" ({theirs} pixels; the model takes {ours})" if ours != theirs else ""
    raise InputError(
        where,
        f"is of another camera than the model was exported for{sizes}",
        "export for this camera with `horizon-dl export RUN --camera DATA`",
    )


def same_camera(one: Camera, other: Camera) -> bool:
    """Whether two cameras are equal up to rounding in files."""
    first, second = _numbers(one), _numbers(other)
    same_kind = one.model == other.model and len(first) == len(second)
    return same_kind and all(
        isclose(a, b, rel_tol=1e-6, abs_tol=1e-9) for a, b in zip(first, second, strict=True)
    )


def _numbers(camera: Camera) -> list[float]:
    fields = asdict(camera)
    return [float(v) for key, v in fields.items() if key not in ("model", "distortion")] + list(
        camera.distortion
    )


def _size(camera: Camera) -> str:
    return f"{camera.width}x{camera.height}"
