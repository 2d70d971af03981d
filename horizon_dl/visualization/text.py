"""Small text labels on pictures, with the font that comes with Pillow."""

from functools import lru_cache

import numpy as np
from PIL import Image as PilImage
from PIL import ImageDraw, ImageFont

from horizon_dl.visualization.colours import Colour, Image

DARK: Colour = (40, 44, 52)
SOFT: Colour = (110, 116, 128)


@lru_cache
def font(size_px: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font in a size, the same on every machine."""
    return ImageFont.load_default(size=size_px)


@lru_cache(maxsize=2048)
def text_size(text: str, size_px: int) -> tuple[int, int]:
    """Width and height in pixels of a line of text."""
    left, _, right, _ = font(size_px).getbbox(text)
    return int(right - left) + 1, int(size_px * 1.3) + 1


@lru_cache(maxsize=512)
def text_image(text: str, size_px: int, colour: Colour = DARK, ground: Colour = (255, 255, 255)) -> Image:
    """(h, w, 3) uint8: a line of text, as large as it needs to be; not to be written into."""
    canvas = PilImage.new("RGB", text_size(text, size_px), ground)
    ImageDraw.Draw(canvas).text((0, 0), text, font=font(size_px), fill=colour)
    return np.asarray(canvas, np.uint8)


def shorten(text: str, size_px: int, width_px: int) -> str:
    """The text, or its beginning and an ellipsis, so that it fits into a width."""
    if text_size(text, size_px)[0] <= width_px:
        return text
    while text and text_size(text + "...", size_px)[0] > width_px:
        text = text[:-1]
    return text.rstrip() + "..."


def paste(canvas: Image, picture: Image, top: int, left: int) -> None:
    """Lays a picture onto the canvas in place, cut off where it would stand over the edge."""
    height = max(0, min(picture.shape[0], canvas.shape[0] - top))
    width = max(0, min(picture.shape[1], canvas.shape[1] - left))
    canvas[top : top + height, left : left + width] = picture[:height, :width]
