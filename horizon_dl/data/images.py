"""Reads one frame of a recording: decode, turn upright, check."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.frame import Frame, Recording, Truth
from horizon_dl.errors import FrameError
from horizon_dl.geometry.camera import Camera


def load_frame(recording: Recording, index: int) -> Frame:
    """The frame at an index with its image and truth in memory.

    Raises:
        FrameError: the image or the truth cannot be read or has another size than the camera.
    """
    entry = recording.entries[index]
    image = load_rgb(entry.image_path)
    image = np.ascontiguousarray(np.rot90(image, recording.rotate_quarter_turns_ccw))
    _check_size(entry.image_path, image, recording.camera)
    truth = None if entry.truth_path is None else _load_truth(entry.truth_path, recording.camera)
    return Frame(
        entry.name,
        entry.time_s,
        image,
        recording.camera,
        entry.up_cam,
        entry.height_m,
        truth,
        entry.floor_up_cam,
    )


def load_counts(path: Path) -> NDArray[np.uint16]:
    """(h, w) numbers of a 16-bit range image, as they are stored; FrameError where it is none."""
    image = _decode(path)
    if not image.mode.startswith("I"):
        raise FrameError(path, f"has the mode {image.mode}", "store ranges as one channel of 16 bits")
    return np.asarray(image).astype(np.uint16)


def load_rgb(path: Path) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 RGB of an image file, as it is stored; FrameError where it cannot be read."""
    return to_rgb(_decode(path), path)


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
    return np.array(image.convert("RGB"))


def _decode(path: Path) -> Image.Image:
    try:
        with Image.open(path) as image:
            image.load()
            return image.copy()
    except FileNotFoundError:
        raise FrameError(path, "is missing", "restore the file or leave the frame out") from None
    except (OSError, SyntaxError, ValueError, EOFError, Image.DecompressionBombError) as error:
        # Pillow's message may hold a path or an address of an object; the kind is enough.
        kind = "is truncated" if "truncated" in str(error) else "cannot be read as an image"
        raise FrameError(path, kind, "restore the file or leave the frame out") from None


def _load_truth(path: Path, camera: Camera) -> NDArray[np.uint8]:
    image = _decode(path)
    if len(image.getbands()) != 1:
        raise FrameError(
            path, f"has {len(image.getbands())} channels", "store labels as one channel of 8 bits"
        )
    values = np.asarray(image)
    _check_size(path, values, camera)
    if values.min() < 0 or values.max() > max(Truth):
        raise FrameError(
            path,
            f"holds the value {values.max() if values.max() > max(Truth) else values.min()}",
            "labels are 0 ignore, 1 floor, 2 obstacle, 3 above",
        )
    return values.astype(np.uint8)


def _check_size(path: Path, image: NDArray[np.generic], camera: Camera) -> None:
    height, width = image.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise FrameError(
            path,
            f"is {width}x{height} pixels when upright, the camera {camera.width}x{camera.height}",
            "use the image size that the camera was calibrated for",
        )
