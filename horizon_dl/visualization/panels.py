"""Panels: image, what is flown, the paper's uncertainty and obstacle map, truth; a row a method."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from horizon_dl.output import write_bytes
from horizon_dl.visualization.cells import Cells
from horizon_dl.visualization.colours import ABOVE_COLOUR, BELOW_COLOUR, OBSTACLE_COLOUR, Image, lookup_table
from horizon_dl.visualization.flown import RANGES_TITLE
from horizon_dl.visualization.text import SOFT, paste, shorten, text_image

Floats = NDArray[np.floating]

FLOWN_TITLE = "surprisal, the score that is flown"
ENTROPY_TITLE = "entropy, the paper's score"
OBSTACLES_TITLE = "entropy over the paper's threshold"

_MARGIN = 14
_GAP = 10
_TITLE_PX = 15
_SMALL_PX = 12
_STRIP = 24  # height of a strip of titles
_NAME_WIDTH = 22  # room for the methods' names, written upwards

_Cell = tuple[str, Image]  # title and picture
_Grid = Sequence[Sequence[_Cell | None]]


@dataclass(frozen=True)
class PanelRow:
    """What one method says of one frame; every map (h, w), all of one size.

    Attributes:
        name: shown at the left of the row, such as "CNN".
        p_above: probability in [0, 1] that the pixel belongs above the horizon, or None.
        flown: the score that is flown, in [0, 1], or None.
        ranges: the bearings that are flown, drawn at any size of the image's aspect, or None.
        ranges_title: what those are.
        entropy: the paper's score, bits, or None.
        obstacles: the paper's obstacle map, or None.
    """

    name: str
    p_above: Floats | None = None
    flown: Floats | None = None
    ranges: Image | None = None
    ranges_title: str = RANGES_TITLE
    entropy: Floats | None = None
    obstacles: NDArray[np.bool_] | None = None


def _row_cells(cells: Cells, row: PanelRow) -> list[_Cell]:
    drawn: list[_Cell] = []
    if row.p_above is not None:
        drawn.append(("classification", cells.map(row.p_above, "sides")))
    if row.flown is not None:
        drawn.append((FLOWN_TITLE, cells.map(row.flown, "uncertainty")))
    if row.ranges is not None:
        drawn.append((row.ranges_title, cells.picture(row.ranges)))
    if row.entropy is not None:
        drawn.append((ENTROPY_TITLE, cells.map(row.entropy, "uncertainty")))
    if row.obstacles is not None:
        drawn.append((OBSTACLES_TITLE, cells.obstacles(row.obstacles)))
    return drawn


def _legend(width: int, with_truth: bool) -> Image:
    """A strip of thin colour bars and swatches that says what the colours mean."""
    strip = np.full((_STRIP, width, 3), 255, np.uint8)
    left = 0
    for table, low, high in (("sides", "below", "above"), ("uncertainty", "sure", "unsure")):
        bar = np.repeat(lookup_table(table)[None, ::2], 10, axis=0)
        left = _put(strip, text_image(low, _SMALL_PX, SOFT), 2, left) + 7
        left = _put(strip, bar, 5, left) + 7
        left = _put(strip, text_image(high, _SMALL_PX, SOFT), 2, left) + 24
    swatches = [("obstacle", OBSTACLE_COLOUR)]
    if with_truth:
        swatches += [("floor (truth)", BELOW_COLOUR), ("ceiling or sky (truth)", ABOVE_COLOUR)]
    for name, colour in swatches:
        left = _put(strip, np.full((10, 16, 3), colour, np.uint8), 5, left) + 7
        left = _put(strip, text_image(name, _SMALL_PX, SOFT), 2, left) + 16
    return strip


def _put(strip: Image, piece: Image, top: int, left: int) -> int:
    """Pastes a piece if it fits as a whole; where the next one starts."""
    if left + piece.shape[1] <= strip.shape[1]:
        paste(strip, piece, top, left)
    return int(left + piece.shape[1])


def _grid(image_cell: Image, truth_cell: Image | None, row_cells: Sequence[list[_Cell]]) -> _Grid:
    """Cells by row and column: the truth ends a single row; with several rows it stands under the image."""
    image: _Cell = ("image", image_cell)
    truth: list[_Cell] = [] if truth_cell is None else [("truth", truth_cell)]
    if len(row_cells) < 2:
        return [[image, *(row_cells[0] if row_cells else []), *truth]]
    first_column: list[_Cell | None] = [image, *truth, *[None] * len(row_cells)]
    return [[first, *drawn] for first, drawn in zip(first_column, row_cells, strict=False)]


class _Layout:
    """Where the cells of a grid stand on the canvas."""

    def __init__(self, cells: Cells, grid: _Grid, has_names: bool, has_title: bool, legend: bool) -> None:
        columns = max(len(line) for line in grid)
        self.cell_width: int = cells.width
        self.cell_height: int = cells.height
        self.name_left = _MARGIN + cells.width + _GAP
        names_width = _NAME_WIDTH if has_names and columns > 1 else 0
        step = cells.width + _GAP
        self.left_of = [_MARGIN, *(_MARGIN + names_width + column * step for column in range(1, columns))]
        self.width = self.left_of[-1] + cells.width + _MARGIN
        self._first_top: int = _MARGIN + (_STRIP if has_title else 0) + _STRIP
        self.height = self.top_of(len(grid)) - _STRIP - _GAP + _MARGIN + (_STRIP + 8 if legend else 0)

    def top_of(self, row: int) -> int:
        """First pixel row of a row's cells."""
        return self._first_top + row * (_STRIP + self.cell_height + _GAP)


def _draw_row(canvas: Image, layout: _Layout, top: int, line: Sequence[_Cell | None], name: str) -> None:
    for left, cell in zip(layout.left_of, line, strict=False):
        if cell is not None:
            label = shorten(cell[0], _SMALL_PX, layout.cell_width)
            paste(canvas, text_image(label, _SMALL_PX, SOFT), top - 19, left)
            paste(canvas, cell[1], top, left)
    if name and len(layout.left_of) > 1:
        upright = np.rot90(text_image(shorten(name, _TITLE_PX, layout.cell_height), _TITLE_PX))
        paste(canvas, upright, top + (layout.cell_height - upright.shape[0]) // 2, layout.name_left)


def frame_panel(
    image: Image,
    elevation: Floats,
    rows: Sequence[PanelRow],
    truth: NDArray[np.uint8] | None = None,
    *,
    title: str = "",
    cell_width: int = 320,
    legend: bool = True,
) -> Image:
    """One picture of a frame: image | what is flown | the paper's uncertainty and obstacle map | truth.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        rows: one a method; their maps may have another size than the image.
        truth: (H, W) of `Truth`, any size, or None.
        title: heading, such as the frame's name.
        cell_width: width of each cell in pixels.
        legend: whether to explain the colours underneath.

    Returns:
        (H, W, 3) uint8 RGB on white.

    Example:
        >>> elevation = np.linspace(0.3, -0.3, 24)[:, None] * np.ones((1, 32))
        >>> row = PanelRow("CNN", p_above=np.full((24, 32), 0.5), entropy=np.ones((24, 32)))
        >>> frame_panel(np.zeros((24, 32, 3), np.uint8), elevation, [row], cell_width=64).ndim
        3
    """
    cells = Cells(image, elevation, cell_width)
    truth_cell = None if truth is None else cells.truth(truth)
    grid = _grid(cells.photo(), truth_cell, [_row_cells(cells, row) for row in rows])
    layout = _Layout(
        cells, grid, has_names=any(row.name for row in rows), has_title=bool(title), legend=legend
    )
    canvas = np.full((layout.height, layout.width, 3), 255, np.uint8)
    inner_width = layout.width - 2 * _MARGIN
    if title:
        paste(canvas, text_image(shorten(title, _TITLE_PX, inner_width), _TITLE_PX), _MARGIN - 2, _MARGIN)
    for index, line in enumerate(grid):
        _draw_row(canvas, layout, layout.top_of(index), line, rows[index].name if index < len(rows) else "")
    if legend:
        paste(canvas, _legend(inner_width, truth is not None), layout.height - _MARGIN - _STRIP + 4, _MARGIN)
    return canvas


def image_bytes(picture: Image, format: str = "PNG") -> bytes:
    """The picture as the bytes of a `PNG` or `JPEG` file."""
    buffer = io.BytesIO()
    options = {"quality": 90} if format == "JPEG" else {"optimize": True}
    PilImage.fromarray(picture).save(buffer, format, **options)
    return buffer.getvalue()


def save_panel(path: Path, picture: Image) -> None:
    """Writes a picture as PNG or JPEG by the path's ending, beside the target first and then renamed."""
    kind = "JPEG" if path.suffix.lower() in (".jpg", ".jpeg") else "PNG"
    write_bytes(path, image_bytes(picture, kind))
