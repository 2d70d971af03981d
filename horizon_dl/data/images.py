"""Image files: decoded, checked, brought to RGB."""

import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import Truth
from horizon_dl.data.regular_file import check_regular
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.camera import Camera

FORMATS = ("JPEG", "PNG", "BMP", "PPM", "TIFF", "WEBP")
"""Decoders that strangers' files may reach; some of Pillow's others start programs."""
MOST_PIXELS = 36_000_000
"""Where no camera is known: decoded and brought to RGB it takes a quarter of a gigabyte."""
LEAST_LIMIT = 4_000_000

# Sizes are checked here, before anything is decoded.
warnings.filterwarnings("ignore", category=Image.DecompressionBombWarning)


def most_pixels(camera: Camera | None) -> int:
    """How many pixels an image may have; one of another size than the camera's is still read."""
    if camera is None:
        return MOST_PIXELS
    return max(LEAST_LIMIT, 4 * camera.width * camera.height)


def load_uint16(path: Path) -> NDArray[np.uint16]:
    """(h, w) numbers of an image with one channel of 16 bits, as they are stored.

    Raises:
        FrameError: it cannot be read, or is none.
    """
    image = _decode(path)
    if not image.mode.startswith("I"):
        raise FrameError(path, f"has the mode {image.mode}", "store it as one channel of 16 bits")
    return np.asarray(image).astype(np.uint16)


def load_rgb(path: Path, most_pixels: int = MOST_PIXELS) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 RGB of an image file, as it is stored.

    Raises:
        FrameError: it cannot be read, or has more pixels than that.
    """
    return to_rgb(_decode(path, most_pixels), path)


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


def _decode(path: Path, most_pixels: int = MOST_PIXELS) -> Image.Image:
    """The image; its size is looked at before it is decoded, since some hundred bytes may hold gigabytes."""
    try:
        check_regular(path)
        with Image.open(path, formats=FORMATS) as image:
            if image.width * image.height > most_pixels:
                problem = f"is {image.width}x{image.height} pixels, more than is read here"
                raise FrameError(path, problem, "use the image size that the camera was calibrated for")
            image.load()
            return image
    except FrameError:
        raise
    except InputError as error:
        raise FrameError(*error.args) from None
    except FileNotFoundError:
        raise FrameError(path, "is missing", "restore the file or leave the frame out") from None
    except (MemoryError, Image.DecompressionBombError):
        raise FrameError(path, "is too large", "store it smaller") from None
    except Exception as error:  # Pillow's decoders have a dozen of their own for damaged files
        # Pillow's message may hold a path or an address of an object; the kind is enough.
        kind = "is truncated" if "truncated" in str(error) else "cannot be read as an image"
        raise FrameError(path, kind, "restore the file or leave the frame out") from None


def load_truth(path: Path, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """(H, W) uint8 of `Truth`.

    Raises:
        FrameError: it cannot be read, has another size than its upright image, or holds other values.
    """
    image = _decode(path)
    if len(image.getbands()) != 1:
        problem = f"has {len(image.getbands())} channels"
        raise FrameError(path, problem, "store labels as one channel of 8 bits")
    values = np.asarray(image)
    if values.shape != shape:
        sizes = f"is {values.shape[1]}x{values.shape[0]} pixels, its upright image {shape[1]}x{shape[0]}"
        raise FrameError(path, sizes, "store labels at the size of the upright image")
    worst = values.max() if values.max() > max(Truth) else values.min()
    if not 0 <= worst <= max(Truth):
        raise FrameError(
            path, f"holds the value {worst}", "labels are 0 ignore, 1 floor, 2 obstacle, 3 above"
        )
    return values.astype(np.uint8)
