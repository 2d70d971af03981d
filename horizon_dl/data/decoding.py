"""Decodes image files: bounded in size, by few of Pillow's decoders, all bits of deep ones."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.regular_file import check_regular
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.camera import Camera

FORMATS = ("JPEG", "PNG", "BMP", "PPM", "TIFF", "WEBP")
"""Decoders that strangers' files may reach; some of Pillow's others start programs."""

MOST_PIXELS = 36_000_000
"""Where no camera is known: decoded and brought to RGB it takes a quarter of a gigabyte."""

LEAST_LIMIT = 4_000_000

# Sizes are checked here before anything is decoded, and a damaged file is an error or a picture, no third.
warnings.filterwarnings("ignore", category=Image.DecompressionBombWarning)
warnings.filterwarnings("ignore", module=r"PIL\.")

DEEP = ";16"
"""In Pillow's names of raw modes: 16 bits a channel; of several channels it keeps the upper 8."""


def most_pixels(camera: Camera | None) -> int:
    """How many pixels an image may have; one of another size than the camera's is still read."""
    if camera is None:
        return MOST_PIXELS
    return max(LEAST_LIMIT, 4 * camera.width * camera.height)


def is_deep(image: Image.Image) -> bool:
    """Whether a decoded image had 16 bits a channel in its file."""
    return image.mode.startswith("I") or bool(image.info.get(DEEP))


def deep_values(path: Path, image: Image.Image) -> NDArray[np.uint16]:
    """(H, W) or (H, W, 3) values of an image that `is_deep`, all bits of them.

    Raises:
        FrameError: it cannot be read, or has values of more than 16 bits.
    """
    if image.mode.startswith("I"):
        values = np.asarray(image)
        if values.size and (values.min() < 0 or values.max() > 65535):
            raise FrameError(path, "has grey values over 16 bits", "store it with 8 or 16 bits")
        return values.astype(np.uint16)
    upper, lower = (np.asarray(one.convert("RGB"), np.uint16) for one in (image, decode(path, lower=True)))
    return np.asarray(upper << 8 | lower, np.uint16)


def decode(path: Path, most_pixels: int = MOST_PIXELS, *, lower: bool = False) -> Image.Image:
    """The decoded image, as stored; Pillow turns TIFF images itself, and they have no orientation then.

    Its size is looked at before it is decoded, since some hundred bytes may hold gigabytes.

    Args:
        path: of the file.
        most_pixels: of an image that is decoded.
        lower: of 16 bits in several channels, the lower 8 in place of the upper ones.

    Raises:
        FrameError: it cannot be read, or is larger than that.
    """
    try:
        check_regular(path)
        # By its file and not by its name: Pillow maps files with a name into memory, and then gets those TIFF
        # images wrong that are to be turned.
        with path.open("rb") as file, Image.open(file, formats=FORMATS) as image:
            if image.width * image.height > most_pixels:
                problem = f"is {image.width}x{image.height} pixels, more than is read here"
                raise FrameError(path, problem, "use the image size that the camera was calibrated for")
            deep = any(DEEP in str(tile[3]) for tile in image.tile)
            if lower:
                image.tile = [_lower(tile) for tile in image.tile]
            image.load()
            if deep:
                image.info[DEEP] = True
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


def _lower(tile: Any) -> Any:
    """What is to be decoded, with the order of the two bytes swapped: then the lower one is kept."""
    swap = {";16B": ";16L", ";16L": ";16B"}

    def swapped(argument: Any) -> Any:
        end = argument[-4:] if isinstance(argument, str) else ""
        return argument[:-4] + swap[end] if end in swap else argument

    codec, extents, offset, arguments = tile
    is_text = isinstance(arguments, str)
    changed = swapped(arguments) if is_text else tuple(swapped(argument) for argument in arguments)
    return type(tile)(codec, extents, offset, changed)
