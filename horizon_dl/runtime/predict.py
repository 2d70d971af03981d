"""A model file on a data set or on plain pictures, without torch."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import isclose
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.data.source import FrameSource
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.camera import Camera
from horizon_dl.runtime.model import ObstacleModel, Outputs
from horizon_dl.runtime.perception import model_rays
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.panels import PanelRow, frame_panel
from horizon_dl.visualization.range_picture import range_picture


@dataclass(frozen=True)
class FileOutputs:
    """What a model file says of one frame.

    Attributes:
        frame: what was looked at.
        outputs: of the model.
        ranges: distances per bearing, drawn; None without attitude or height.
    """

    frame: Frame
    outputs: Outputs
    ranges: Image | None = None

    def arrays(self) -> dict[str, Any]:
        """All maps by name at the working size, the float ones as float16, as a run folder gives them."""
        maps = {
            name: value
            for name, value in vars(self.outputs).items()
            if name not in ("elevation", "obstacles")
        }
        small = {name: value.astype(np.float16) for name, value in maps.items()}
        return {**small, "obstacles": self.small_obstacles(), "elevation_rad": self.outputs.elevation}

    def small_obstacles(self) -> NDArray[np.bool_]:
        """The obstacle map at the working size, which the model enlarged by repeating pixels."""
        (height, width), small = self.outputs.obstacles.shape, self.outputs.entropy.shape
        rows = ((np.arange(small[0]) + 0.5) * (height / small[0])).astype(int)
        columns = ((np.arange(small[1]) + 0.5) * (width / small[1])).astype(int)
        return self.outputs.obstacles[np.ix_(rows, columns)]

    def panel(self) -> Image:
        """Image, classification, uncertainty, obstacle map; distances and truth where there are any."""
        found = self.outputs
        row = PanelRow("", found.p_above, found.entropy, self.small_obstacles(), ranges=self.ranges)
        return frame_panel(self.frame.image, found.elevation, [row], self.frame.truth, title=self.frame.name)


def predict_source(model: ObstacleModel, source: FrameSource) -> Iterator[FileOutputs | FrameError]:
    """Every frame, or the error of one that cannot be used.

    Raises:
        InputError: the source has another camera than the model was exported for.
    """
    if source.camera is not None:
        check_camera(model, source.camera, source.name)
    rays = model_rays(model)
    for item in source.frames():
        yield item if isinstance(item, FrameError) else _of_frame(model, rays, item)


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


def _of_frame(model: ObstacleModel, rays: NDArray[np.float32], frame: Frame) -> FileOutputs | FrameError:
    if frame.image.shape[:2] != (model.camera.height, model.camera.width):
        problem = (
            f"is {frame.image.shape[1]}x{frame.image.shape[0]} pixels, the model takes {_size(model.camera)}"
        )
        return FrameError(frame.name, problem, "export for this size with `horizon-dl export RUN --size`")
    found = model.predict(frame.image, frame.up_cam)
    ranges = None
    if frame.height_m is not None:
        ranges = range_picture(frame, rays, found.p_above, model.threshold, model.place)
    return FileOutputs(frame, found, ranges)
