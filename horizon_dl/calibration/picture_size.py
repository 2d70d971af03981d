"""The size of a set's pictures, to choose a camera by."""

from collections.abc import Iterable
from pathlib import Path

from PIL import Image

from horizon_dl.data.decoding import FORMATS
from horizon_dl.data.regular_file import check_regular
from horizon_dl.errors import InputError


def size_of(path: Path) -> tuple[int, int]:
    """Width and height of a picture as stored, pixels; none of them is decoded.

    Raises:
        InputError: it is no picture, or no file at all.
    """
    try:
        check_regular(path)
        with Image.open(path, formats=FORMATS) as image:
            return image.size
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        raise InputError(path, "cannot be read as an image", "restore the file") from None


def picture_size(paths: Iterable[Path]) -> tuple[int, int] | None:
    """Width and height, pixels, of the first of some pictures that can be opened; no pixel is decoded."""
    for path in paths:
        try:
            return size_of(path)
        except InputError:
            continue
    return None
