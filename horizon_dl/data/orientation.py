"""EXIF orientation: how a camera says that its stored image is to be turned."""

from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.regular_file import check_regular

TAG = 0x0112
AS_STORED = 1
Array = TypeVar("Array", bound=NDArray[Any])


def orientation_of(image: Image.Image) -> int:
    """The EXIF orientation, 1 to 8; 1 (as stored) where there is none, or none that makes sense."""
    try:
        value = image.getexif().get(TAG, AS_STORED)
    except Exception:  # Pillow raises whatever a damaged block makes it stumble over
        return AS_STORED
    return value if value in range(1, 9) else AS_STORED


def orientation_of_file(path: Path) -> int:
    """The EXIF orientation of an image file; 1 where it cannot be read."""
    try:
        check_regular(path)
        with Image.open(path, formats=("JPEG", "PNG", "TIFF", "WEBP")) as image:
            return orientation_of(image)
    except Exception:  # as above
        return AS_STORED


def upright(stored: Array, orientation: int) -> Array:
    """An image (H, W) or (H, W, C) as its EXIF orientation wants it shown.

    Example:
        >>> stored = np.array([[1, 2, 3], [4, 5, 6]])
        >>> upright(stored, 3).tolist(), upright(stored, 6).tolist()
        ([[6, 5, 4], [3, 2, 1]], [[4, 1], [5, 2], [6, 3]])
    """
    turned: Any = stored
    if orientation in (5, 6, 7, 8):
        turned = np.swapaxes(turned, 0, 1)
    if orientation in (3, 4, 7, 8):
        turned = turned[::-1]
    if orientation in (2, 3, 6, 7):
        turned = turned[:, ::-1]
    return cast(Array, np.ascontiguousarray(turned))
