"""Sinks that write a file a frame: panels and arrays."""

from pathlib import Path

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.output.names import ResultNames
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.flown import RANGES_TITLE, ranges_title
from horizon_dl.visualization.panels import PanelRow, frame_panel, save_panel
from horizon_dl.visualization.range_picture import draw_ranged


class Panels:
    """A sink that writes `NAME.jpg`: image, what is flown, what the paper draws, truth."""

    def __init__(self, folder: Path, names: ResultNames) -> None:
        self._folder, self._names = folder, names

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        save_panel(self._folder / f"{self._names(frame.name)}.jpg", panel(frame, prediction, ranges))

    def close(self) -> None:
        """Nothing is open."""


class Arrays:
    """A sink that writes `NAME.npz`: all maps at the working size."""

    def __init__(self, folder: Path, names: ResultNames) -> None:
        self._folder, self._names = folder, names

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        path = self._folder / f"{self._names(frame.name)}.npz"
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(path, **prediction.arrays())

    def close(self) -> None:
        """Nothing is open."""


def panel(frame: Frame, prediction: Prediction, ranges: Ranged | None) -> Image:
    """One row of cells; what is flown where there is an attitude, truth where there is one."""
    row = panel_row("", prediction, ranges)
    return frame_panel(frame.image, prediction.view.elevation, [row], frame.truth, title=frame.name)


def panel_row(name: str, prediction: Prediction, ranges: Ranged | None) -> PanelRow:
    """What a model says of a frame; without attitude nothing is flown: then its classification."""
    flown = prediction.has_attitude
    return PanelRow(
        name,
        p_above=None if flown else prediction.measures.p_above,
        flown=prediction.flown_score if flown else None,
        ranges=None if ranges is None else drawn_ranges(prediction, ranges),
        ranges_title=RANGES_TITLE if ranges is None else ranges_title(ranges),
        entropy=prediction.measures.entropy,
        obstacles=prediction.obstacles,
    )


def drawn_ranges(prediction: Prediction, ranges: Ranged) -> Image:
    """Bearings and heading over the prediction's picture."""
    assert prediction.directions is not None  # or there were no ranges
    return draw_ranged(prediction.view.image, prediction.directions, ranges)
