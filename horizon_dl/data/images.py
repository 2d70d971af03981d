"""Image files: decoded, turned as their EXIF says, checked, brought to 8 bits of RGB."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.decoding import MOST_PIXELS, decode, deep_values, is_deep
from horizon_dl.data.frame import Truth
from horizon_dl.data.orientation import orientation_of, upright
from horizon_dl.errors import FrameError


def load_uint16(path: Path) -> NDArray[np.uint16]:
    """(h, w) numbers of an image with one channel of 16 bits, as they are stored.

    Raises:
        FrameError: it cannot be read, or is none.
    """
    image = decode(path)
    if not image.mode.startswith("I"):
        raise FrameError(path, f"has the mode {image.mode}", "store it as one channel of 16 bits")
    return np.asarray(image).astype(np.uint16)


def load_rgb(path: Path, most_pixels: int = MOST_PIXELS, bits: int = 16) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 RGB of an image file, upright as every viewer shows it (EXIF orientation applied).

    Args:
        path: of the file.
        most_pixels: of an image that is decoded.
        bits: how many of 16 bits a file of more than 8 uses; larger values are clipped.

    Raises:
        FrameError: it cannot be read, or has more pixels than that.
    """
    image = decode(path, most_pixels)
    if bits < 16 and is_deep(image):
        pixels = from_deep(deep_values(path, image), bits)
    else:
        pixels = to_rgb(image, path)
    return upright(pixels, orientation_of(image))


def to_rgb(image: Image.Image, where: str | Path = "image") -> NDArray[np.uint8]:
    """(H, W, 3) uint8 RGB of an image of any mode; 16-bit grey is scaled by 1/256.

    Raises:
        FrameError: the pixels are numbers that no display range is known for.
    """
    if image.mode.startswith("I"):
        values = np.asarray(image)
        if values.size and (values.min() < 0 or values.max() > 65535):
            raise FrameError(where, "has grey values over 16 bits", "store it with 8 or 16 bits")
        return np.repeat((values // 256).astype(np.uint8)[..., None], 3, axis=-1)
    if image.mode == "F":
        raise FrameError(where, "holds floating-point grey values", "store it with 8 or 16 bits")
    return np.array(image if image.mode == "RGB" else image.convert("RGB"))


def from_deep(values: NDArray[np.uint16], bits: int) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 of (H, W) or (H, W, 3) values of which the lower bits are used.

    Example:
        >>> from_deep(np.array([[0, 16, 4095, 5000]], np.uint16), 12)[0, :, 0].tolist()
        [0, 1, 255, 255]
    """
    grey = np.minimum(values, 2**bits - 1) >> (bits - 8)
    eight = grey.astype(np.uint8)
    return np.repeat(eight[..., None], 3, axis=-1) if eight.ndim == 2 else eight


def load_truth(path: Path, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """(H, W) uint8 of `Truth`.

    Raises:
        FrameError: it cannot be read, has another size than its upright image, or holds other values.
    """
    image = decode(path)
    if len(image.getbands()) != 1:
        problem = f"has {len(image.getbands())} channels"
        raise FrameError(path, problem, "store labels as one channel of 8 bits")
    values = upright(np.asarray(image), orientation_of(image))
    if values.shape != shape:
        sizes = f"is {values.shape[1]}x{values.shape[0]} pixels, its upright image {shape[1]}x{shape[0]}"
        raise FrameError(path, sizes, "store labels at the size of the upright image")
    worst = values.max() if values.max() > max(Truth) else values.min()
    if not 0 <= worst <= max(Truth):
        raise FrameError(
            path, f"holds the value {worst}", "labels are 0 ignore, 1 floor, 2 obstacle, 3 above"
        )
    return values.astype(np.uint8)
