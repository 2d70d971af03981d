"""The size of a set's pictures, to choose a camera by."""

from collections.abc import Iterable
from pathlib import Path

from PIL import Image


def picture_size(paths: Iterable[Path]) -> tuple[int, int] | None:
    """Width and height, pixels, of the first of some pictures that can be opened; no pixel is decoded."""
    for path in paths:
        try:
            with Image.open(path) as image:
                return image.size
        except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
            continue
    return None
