"""A picture of any size for a model that takes one: scaled as a whole, its borders repeated beside it."""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from horizon_dl.geometry.resize import area_resize

T = TypeVar("T", bound=np.generic)

SAME_ASPECT = 0.02


@dataclass(frozen=True)
class FittedPicture:
    """A picture at a model's size.

    Attributes:
        image: (H, W, 3) uint8 RGB, of the model's size.
        rows, columns: from and up to where the picture lies in it; around it are its repeated borders.
    """

    image: NDArray[np.uint8]
    rows: tuple[int, int]
    columns: tuple[int, int]

    def part(self, whole: NDArray[T]) -> NDArray[T]:
        """What of a map over the model's image, (h, w, ...) at any size, lies on the picture."""
        height, width = self.image.shape[:2]
        first, last = (round(row * whole.shape[0] / height) for row in self.rows)
        left, right = (round(column * whole.shape[1] / width) for column in self.columns)
        return whole[first : max(last, first + 1), left : max(right, left + 1)]


def fit_picture(image: NDArray[np.uint8], width: int, height: int) -> FittedPicture:
    """The picture in the middle of a model's size, as large as it goes.

    Where its aspect is the model's to 2 %, it fills all of it.

    Args:
        image: (h, w, 3) uint8 RGB.
        width: of the model's images, pixels.
        height: the same.

    Example:
        >>> fitted = fit_picture(np.zeros((50, 200, 3), np.uint8), 100, 80)
        >>> fitted.rows, fitted.columns
        ((27, 52), (0, 100))
    """
    scale = min(width / image.shape[1], height / image.shape[0])
    inner = max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale))
    if inner[0] >= width * (1 - SAME_ASPECT) and inner[1] >= height * (1 - SAME_ASPECT):
        inner = width, height
    top, left = (height - inner[1]) // 2, (width - inner[0]) // 2
    around = ((top, height - inner[1] - top), (left, width - inner[0] - left), (0, 0))
    filled = np.pad(_resized(image, inner), around, mode="edge")
    return FittedPicture(filled, (top, top + inner[1]), (left, left + inner[0]))


def _resized(image: NDArray[np.uint8], size: tuple[int, int]) -> NDArray[np.uint8]:
    """The image at `size` = (width, height): by area where it gets smaller both ways, else between pixels."""
    if size[0] <= image.shape[1] and size[1] <= image.shape[0]:
        return area_resize(image, size)
    return np.asarray(PilImage.fromarray(image).resize(size, PilImage.Resampling.BILINEAR))
