"""Sinks that write a file a frame: panels and arrays."""

from collections.abc import Sequence
from os.path import commonpath
from pathlib import Path, PurePosixPath

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.panels import PanelRow, frame_panel, save_panel
from horizon_dl.visualization.range_picture import draw_ranged


class ResultNames:
    """Where the results of frames are written: by the frame's path below the folder that all share.

    Example:
        >>> names = ResultNames(["images/a/1.png", "images/b/1.png"])
        >>> names("images/b/1.png", ".jpg").as_posix()
        'b/1.jpg'
    """

    def __init__(self, frames: Sequence[str] = ()) -> None:
        folders = {str(_inside(name).parent) for name in frames}
        shared = commonpath(folders) if folders else ""
        self._shared = PurePosixPath(shared)
        self._taken: dict[PurePosixPath, str] = {}

    def __call__(self, frame: str, suffix: str) -> PurePosixPath:
        """The relative path for a frame; `1.png` and `1.jpg` in one folder keep their endings."""
        path = _inside(frame)
        if path.is_relative_to(self._shared):
            path = path.relative_to(self._shared)
        plain = path.with_suffix(suffix) if path.suffix else path.with_name(path.name + suffix)
        if self._taken.setdefault(plain, frame) != frame:
            return path.with_name(path.name + suffix)
        return plain


def _inside(name: str) -> PurePosixPath:
    """A frame's name as a path that cannot leave the folder it is written to."""
    parts = [part for part in PurePosixPath(name.replace("\\", "/")).parts if part not in ("/", "..", ".")]
    return PurePosixPath(*parts) if parts else PurePosixPath("frame")


class Panels:
    """A sink that writes `NAME.jpg`: image, classification, uncertainty, obstacle map, distances, truth."""

    def __init__(self, folder: Path, names: ResultNames) -> None:
        self._folder, self._names = folder, names

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        save_panel(self._folder / self._names(frame.name, ".jpg"), panel(frame, prediction, ranges))

    def close(self) -> None:
        """Nothing is open."""


class Arrays:
    """A sink that writes `NAME.npz`: all maps at the working size."""

    def __init__(self, folder: Path, names: ResultNames) -> None:
        self._folder, self._names = folder, names

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        path = self._folder / self._names(frame.name, ".npz")
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(path, **prediction.arrays())

    def close(self) -> None:
        """Nothing is open."""


def panel(frame: Frame, prediction: Prediction, ranges: Ranged | None) -> Image:
    """One row of cells; distances where there are metres, truth where there is one."""
    row = PanelRow(
        "",
        prediction.measures.p_above,
        prediction.score,
        prediction.obstacles,
        ranges=drawn_ranges(prediction, ranges) if ranges is not None and ranges.has_metres else None,
    )
    return frame_panel(frame.image, prediction.view.elevation, [row], frame.truth, title=frame.name)


def drawn_ranges(prediction: Prediction, ranges: Ranged) -> Image:
    """Distances and heading over the prediction's picture."""
    assert prediction.directions is not None  # or there were no ranges
    return draw_ranged(prediction.view.image, prediction.directions, ranges)
