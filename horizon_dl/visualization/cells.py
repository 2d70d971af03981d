"""The cells of a panel: one frame drawn in one size, each cell with the horizon."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from horizon_dl.geometry.resize import nearest
from horizon_dl.visualization.colours import Image, colour_map
from horizon_dl.visualization.overlays import (
    draw_obstacles,
    draw_strokes,
    draw_truth,
    horizon_strokes,
    shrink_truth,
)

Floats = NDArray[np.floating]


def resize_image(image: Image, width: int, height: int) -> Image:
    """(height, width, 3): area-averaged when it shrinks, bicubic when it grows."""
    shrinks = width < image.shape[1]
    how = PilImage.Resampling.BOX if shrinks else PilImage.Resampling.BICUBIC
    return np.asarray(PilImage.fromarray(image).resize((width, height), how), np.uint8)


def resize_map(values: Floats, width: int, height: int) -> NDArray[np.float32]:
    """(height, width) float32, bilinear; pixels that touch a NaN become NaN."""
    resized = PilImage.fromarray(np.asarray(values, np.float32)).resize(
        (width, height), PilImage.Resampling.BILINEAR
    )
    return np.array(resized, np.float32)


def _resize_mask(mask: NDArray[np.bool_], width: int, height: int) -> NDArray[np.bool_]:
    return nearest(np.asarray(mask, bool), height, width)


class Cells:
    """Draws the cells of one frame, all of one size, each with the horizon.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        width: of a cell in pixels; the height follows from the image's aspect.
    """

    def __init__(self, image: Image, elevation: Floats, width: int) -> None:
        self.width = width
        self.height = max(1, round(image.shape[0] * width / image.shape[1]))
        self.image = resize_image(image, self.width, self.height)
        self.elevation = resize_map(elevation, self.width, self.height)
        self._horizon = horizon_strokes(self.elevation)

    def photo(self) -> Image:
        """The image itself."""
        return self._with_horizon(self.image)

    def picture(self, drawn: Image) -> Image:
        """A picture of any size that is drawn already."""
        return resize_image(drawn, self.width, self.height)

    def map(self, values: Floats, table: str) -> Image:
        """Values in [0, 1], any size, through the colour map `sides` or `uncertainty`."""
        return self._with_horizon(colour_map(resize_map(values, self.width, self.height), table))

    def obstacles(self, mask: NDArray[np.bool_]) -> Image:
        """An obstacle map of any size over the grey image."""
        drawn = draw_obstacles(self.image, _resize_mask(mask, self.width, self.height))
        return self._with_horizon(drawn)

    def truth(self, truth: NDArray[np.uint8]) -> Image:
        """A truth of any size over the grey image."""
        drawn = draw_truth(self.image, shrink_truth(truth, self.width, self.height))
        return self._with_horizon(drawn)

    def _with_horizon(self, picture: Image) -> Image:
        return draw_strokes(picture, self._horizon)
