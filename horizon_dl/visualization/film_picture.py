"""One picture of a film: image, what is flown, and beside it what the paper draws."""

import math
from collections.abc import Sequence

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.cells import Cells
from horizon_dl.visualization.colours import Colour, Image
from horizon_dl.visualization.file_sinks import drawn_ranges
from horizon_dl.visualization.flown import ranges_title, unknown_words
from horizon_dl.visualization.panels import ENTROPY_TITLE, FLOWN_TITLE, OBSTACLES_TITLE
from horizon_dl.visualization.text import paste, shorten, text_image
from horizon_dl.visualization.top_view import draw_top_view

GROUND: Colour = (22, 24, 28)
EMPTY: Colour = (36, 40, 46)
INK: Colour = (232, 235, 240)
SOFT: Colour = (168, 176, 188)
CELL_WIDTH = 400
CLASSIFICATION = "classification: below green, above blue"
_GAP = 10
_TITLE = 34
_LABEL = 22

Cell = tuple[str, Image]


class FilmPicture:
    """Lays out every frame of a source alike, three cells in a row.

    Args:
        with_ground: leave room for distances and the ground from above, and say where they are not known.
        cell_width: of each cell, pixels.
    """

    def __init__(self, with_ground: bool, cell_width: int = CELL_WIDTH) -> None:
        self._with_ground, self._cell_width = with_ground, cell_width
        self._cell_height: int | None = None

    def __call__(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> Image:
        """(H, W, 3) uint8 of even sides, of the same size for every frame."""
        cells = Cells(frame.image, prediction.view.elevation, self._cell_width)
        if self._cell_height is None:
            self._cell_height = cells.height - cells.height % 2
        if prediction.has_attitude:
            says = (FLOWN_TITLE, cells.map(prediction.flown_score, "uncertainty"))
        else:
            says = (CLASSIFICATION, cells.map(prediction.measures.p_above, "sides"))
        drawn: list[Cell] = [("image", cells.photo()), says]
        if self._with_ground:
            drawn += self._flown(cells, prediction, ranges)
        drawn += [
            (ENTROPY_TITLE, cells.map(prediction.measures.entropy, "uncertainty")),
            (OBSTACLES_TITLE, cells.obstacles(prediction.obstacles)),
        ]
        return self._laid_out(drawn, frame, title_of(ranges))

    def _flown(self, cells: Cells, prediction: Prediction, ranges: Ranged | None) -> list[Cell]:
        if ranges is None:
            return [("flown: nothing, no attitude", self._empty()), ("from above: nothing", self._empty())]
        above = draw_top_view(ranges, self._cell_width, self._cell_height or 1)
        picture = cells.picture(drawn_ranges(prediction, ranges))
        title = "the same from above, heading" if ranges.has_metres else "from above: bearings, no metres"
        return [(ranges_title(ranges), picture), (title, above)]

    def _empty(self) -> Image:
        return np.full((self._cell_height or 1, self._cell_width, 3), EMPTY, np.uint8)

    def _laid_out(self, drawn: Sequence[Cell], frame: Frame, title: str) -> Image:
        columns = 3 if self._with_ground else 2
        height = self._cell_height or 1
        row_height = _LABEL + height + _GAP
        size = (_TITLE + 2 * row_height, _GAP + columns * (self._cell_width + _GAP))
        canvas = np.broadcast_to(np.array(GROUND, np.uint8), (*size, 3)).copy()
        when = f"{frame.time_s:.2f} s" if math.isfinite(frame.time_s) else ""
        left = text_image(shorten(f"{frame.name}   {when}", 15, canvas.shape[1] // 2), 15, INK, GROUND)
        paste(canvas, left, 8, _GAP)
        right = text_image(title, 15, INK, GROUND)
        paste(canvas, right, 8, max(0, canvas.shape[1] - _GAP - right.shape[1]))
        for index, (name, picture) in enumerate(drawn):
            top = _TITLE + (index // columns) * row_height
            side = _GAP + (index % columns) * (self._cell_width + _GAP)
            paste(canvas, text_image(shorten(name, 13, self._cell_width), 13, SOFT, GROUND), top, side)
            # A source of pictures may change its size on the way: the film cannot.
            paste(canvas, picture[:height], top + _LABEL, side)
        return canvas


def title_of(ranges: Ranged | None) -> str:
    """The nearest obstacle, the heading, and why bearings are unknown, in words."""
    if ranges is None:
        return ""
    nearest, heading = ranges.nearest(), ranges.heading
    near = "" if nearest is None else f"nearest {nearest[0]:.1f} m at {math.degrees(nearest[1]):+.0f}°"
    way = "no free heading" if heading is None else f"heading {math.degrees(heading.bearing_rad):+.0f}°"
    said = (near, way) if ranges.has_metres else ()
    return "; ".join(filter(None, (*said, unknown_words(ranges))))
