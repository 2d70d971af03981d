"""A trained net on new images, with or without attitude."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, Recording
from horizon_dl.data.images import load_frame, load_rgb
from horizon_dl.data.source import Source
from horizon_dl.data.view import View, make_view, working_size
from horizon_dl.errors import FrameError
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.resize import area_resize
from horizon_dl.models.net_measures import net_measures
from horizon_dl.training.run_folder import Run
from horizon_dl.uncertainty.measures import Measures
from horizon_dl.uncertainty.obstacle_map import obstacle_map


@dataclass(frozen=True)
class Prediction:
    """What a net says of one frame.

    Attributes:
        view: the frame at the working size; its elevation is NaN where no attitude is known.
        measures: maps of that size; without attitude the surprisal means nothing.
        obstacles: (h, w) bool, entropy over the run's threshold, lone pixels removed.
        truth: (H, W) uint8 at the frame's own size, or None.
    """

    view: View
    measures: Measures
    obstacles: NDArray[np.bool_]
    truth: NDArray[np.uint8] | None

    def arrays(self) -> dict[str, Any]:
        """All maps by name, the float ones as float16."""
        maps = {name: value.astype(np.float16) for name, value in vars(self.measures).items()}
        return {**maps, "obstacles": self.obstacles, "elevation_rad": self.view.elevation}


Item = tuple[View, Frame | None] | FrameError


def predict(run: Run, view: View, truth: NDArray[np.uint8] | None = None) -> Prediction:
    """Measures and obstacle map of one view."""
    found = net_measures(run.net, view.image, view.elevation > 0)
    return Prediction(view, found, obstacle_map(found.entropy, run.threshold), truth)


def views_of(source: Source, max_pixels: int) -> Iterator[Item]:
    """Views with their frames (plain pictures have none), or the errors of those that cannot be read."""
    if isinstance(source, Recording):
        yield from (_view_of_entry(source, index, max_pixels) for index in range(len(source.entries)))
    else:
        yield from (_view_of_picture(path, max_pixels) for path in source)


def _view_of_entry(recording: Recording, index: int, max_pixels: int) -> Item:
    try:
        frame = load_frame(recording, index)
    except FrameError as error:
        return error
    if frame.up_cam is not None:
        return make_view(frame, max_pixels), frame
    view = make_view(replace(frame, up_cam=np.array([0.0, -1.0, 0.0])), max_pixels)
    return replace(view, elevation=np.full_like(view.elevation, np.nan)), frame


def _view_of_picture(path: Path, max_pixels: int) -> Item:
    try:
        image = load_rgb(path)
    except FrameError as error:
        return error
    height, width = image.shape[:2]
    size = working_size(Camera("pinhole", width, height, 1.0, 1.0, 0.0, 0.0), max_pixels)
    small = area_resize(image, size)
    return View(path.name, 0.0, small, np.full(small.shape[:2], np.nan, np.float32)), None
