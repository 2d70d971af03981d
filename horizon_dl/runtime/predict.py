"""A model file on a data set or on plain pictures, without torch."""

from collections import Counter
from dataclasses import asdict, replace
from math import isclose
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, checked, has_attitude
from horizon_dl.data.source import FrameSource
from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.evidence.judge import working_image
from horizon_dl.evidence.self_assessment import said
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import nearest
from horizon_dl.runtime.fit_picture import FittedPicture, fit_picture
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
        self.doubt = said(model.card.get("self_assessment"))
        self.fitted: Counter[str] = Counter()
        self._rays = model_rays(model)

    def check(self, source: FrameSource) -> None:
        """InputError: the source has another camera than the model was exported for, at whatever size."""
        if source.camera is not None and not _scales_to(source.camera, self.model.camera):
            check_camera(self.model, source.camera, source.name)

    def predict(self, frame: Frame) -> Prediction:
        """See `Predictor`; FrameError for an image of another size than its camera's.

        Images of the model's camera at another size are scaled to the model's: their rays are the same. So
        are plain pictures, whole, whatever camera took them.
        """
        model, image = self.model, checked(frame).image
        if image.shape[:2] == (model.camera.height, model.camera.width):
            found = model.predict(image, frame.up_cam if has_attitude(frame) else None)
            return self._of(frame, found)
        self.fitted[f"{image.shape[1]}x{image.shape[0]}"] += 1
        fitted = fit_picture(image, model.camera.width, model.camera.height)
        known = frame.camera is not None and has_attitude(frame)
        found = model.predict(fitted.image, frame.up_cam if known else None)
        whole = self._of(replace(frame, image=fitted.image), found)
        return whole if frame.camera is not None else _on_picture(whole, fitted)

    def _of(self, frame: Frame, found: Outputs) -> Prediction:
        whole = of_outputs(frame, found, self.model.threshold, self._rays)
        return replace(whole, place=self.model.place, rules=self.model.rules)

    def note(self) -> str | None:
        """What was done to images of other sizes than the model's, in a sentence; None where none were."""
        if not self.fitted:
            return None
        sizes = ", ".join(f"{count} of {size}" for size, count in self.fitted.most_common(3))
        more = "" if len(self.fitted) <= 3 else ", and others"
        return (
            f"images of another size than the model's {_size(self.model.camera)} were scaled whole to "
            f"it: {sizes}{more}; of what it never saw at that scale the model can only guess"
        )


def _on_picture(whole: Prediction, fitted: FittedPicture) -> Prediction:
    """What a model says of a fitted plain picture, without what it says of the repeated borders."""
    view = View(fitted.part(whole.view.image), fitted.part(whole.view.elevation))
    maps = {name: fitted.part(value) for name, value in vars(whole.measures).items()}
    return Prediction(view, Measures(**maps), whole.threshold, fitted.part(whole.obstacles))


def _scales_to(camera: Camera, wanted: Camera) -> bool:
    """Whether a camera is the wanted one at another size, to a thousandth of each number."""
    scaled, other = _numbers(camera.scaled(wanted.width, wanted.height)), _numbers(wanted)
    return (
        camera.model == wanted.model
        and len(scaled) == len(other)
        and all(isclose(a, b, rel_tol=1e-3, abs_tol=1e-6) for a, b in zip(scaled, other, strict=True))
    )


def of_outputs(frame: Frame, found: Outputs, threshold: float, directions: NDArray[np.float32]) -> Prediction:
    """A model file's outputs as a prediction; the obstacle map is the file's own."""
    view = View(working_image(frame.image, found.entropy.shape), found.elevation)
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
