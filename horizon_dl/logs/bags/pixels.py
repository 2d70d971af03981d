"""Pictures of messages: Image in the encodings of ROS, CompressedImage."""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.decoding import is_deep
from horizon_dl.data.images import from_deep, to_rgb
from horizon_dl.errors import FrameError

Bytes = NDArray[np.uint8]

CHANNELS = {
    **dict.fromkeys(("rgb8", "8uc3", "bgr8"), 3),
    **dict.fromkeys(("rgba8", "bgra8", "8uc4"), 4),
    **dict.fromkeys(("mono8", "8uc1", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"), 1),
    **dict.fromkeys(("yuv422", "uyvy", "yuv422_yuy2", "yuyv"), 2),
}
WIDE = {"mono16": 1, "16uc1": 1, "rgb16": 3, "bgr16": 3, "rgba16": 4, "bgra16": 4}
RED_AT = {"rggb": (0, 0), "bggr": (1, 1), "gbrg": (1, 0), "grbg": (0, 1)}
DEPTH = ("16uc1", "32fc1", "mono16")
"""Encodings that depth images have."""
BITS = (8, 10, 12, 14, 16)


def is_depth(message: Any) -> bool:
    """Whether the message is of a depth camera, or a mask of numbers: no picture to look at."""
    encoding = str(getattr(message, "encoding", "") or getattr(message, "format", "")).lower()
    return encoding.split(";")[0].strip() in DEPTH[:2] or "compresseddepth" in encoding.replace(" ", "")


def bits_of(message: Any) -> int:
    """How many bits the pictures of a topic use, by one of them: cameras put 10 or 12 into 16."""
    encoding = str(getattr(message, "encoding", "")).lower()
    if hasattr(message, "format"):
        decoded = _decoded(message, "")
        largest = int(np.asarray(decoded).max(initial=0)) if is_deep(decoded) else 0
    elif encoding in WIDE:
        largest = int(_rows(message, WIDE[encoding], 2, "").max(initial=0))
    else:
        return 8
    return next((bits for bits in BITS if largest < 1 << bits), BITS[-1])


def is_wide(message: Any) -> bool:
    """Whether a picture has two bytes a number."""
    if hasattr(message, "format"):
        return is_deep(_decoded(message, ""))
    return str(message.encoding).lower() in WIDE


def picture(message: Any, where: str, bits: int = 8) -> Bytes:
    """(H, W, 3) uint8 RGB, as it is stored.

    Args:
        message: Image or CompressedImage.
        where: name of the frame.
        bits: of a picture with two bytes a number; see `bits_of`.

    Raises:
        FrameError: an encoding that is not known, or too few bytes.
    """
    if hasattr(message, "format"):
        return _compressed(message, where, bits)
    encoding = str(message.encoding).lower()
    if encoding in WIDE:
        wide = _rows(message, WIDE[encoding], 2, where).astype(np.uint32)
        return _coloured(np.minimum(wide << 8 >> bits, 255).astype(np.uint8), encoding)
    if encoding not in CHANNELS:
        problem = f"has the encoding {message.encoding!r}, which is not read"
        raise FrameError(where, problem, "record rgb8, bgr8, mono8, bayer8, yuv422 or JPEG")
    return _coloured(_rows(message, CHANNELS[encoding], 1, where), encoding)


def _rows(message: Any, channels: int, size: int, where: str) -> NDArray[Any]:
    """(H, W, channels) numbers of the message, the padding of its rows taken off."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    used = width * channels * size
    data = np.asarray(message.data, np.uint8)
    if step == 0:
        step = used
    if used == 0 or step < used or len(data) < step * (height - 1) + used:
        raise FrameError(where, f"has {len(data)} bytes for {width}x{height} pixels", "leave the frame out")
    padded = np.zeros(step * height, np.uint8)
    padded[: len(data)] = data[: len(padded)]
    rows = np.ascontiguousarray(padded.reshape(height, step)[:, :used])
    kind = ">u2" if message.is_bigendian else "<u2"
    return rows.view(np.dtype(kind) if size == 2 else np.uint8).reshape(height, width, channels)


def _coloured(values: NDArray[np.uint8], encoding: str) -> Bytes:
    if encoding.startswith("bayer"):
        return demosaiced(values[..., 0], encoding[6:10])
    if values.shape[2] == 1:
        return np.repeat(values, 3, axis=2)
    if values.shape[2] == 2:
        return _yuv422(values, first_is_y=encoding in ("yuv422_yuy2", "yuyv"))
    return np.ascontiguousarray(values[..., 2::-1] if encoding.startswith("b") else values[..., :3])


def _compressed(message: Any, where: str, bits: int) -> Bytes:
    decoded = _decoded(message, where)
    if is_deep(decoded):
        return from_deep(np.asarray(decoded).astype(np.uint16), bits)
    encoding = str(message.format).lower()
    if encoding.startswith("bayer_") and decoded.mode == "L":
        return demosaiced(np.asarray(decoded), encoding[6:10])
    return to_rgb(decoded, where)


def _decoded(message: Any, where: str) -> Image.Image:
    try:
        with Image.open(io.BytesIO(np.asarray(message.data, np.uint8).tobytes())) as image:
            image.load()
            return image.copy()
    except (OSError, SyntaxError, ValueError, EOFError, Image.DecompressionBombError):
        problem = f"cannot be read as an image (format {str(message.format)[:40]!r})"
        raise FrameError(where, problem, "record JPEG or PNG, or leave the frame out") from None


def _yuv422(values: Bytes, first_is_y: bool) -> Bytes:
    """RGB of pairs of pixels that share their colour (ITU-R BT.601, full range as JFIF has it)."""
    luma, chroma = (values[..., 0], values[..., 1]) if first_is_y else (values[..., 1], values[..., 0])
    blue, red = (np.repeat(chroma[:, start::2], 2, axis=1)[:, : luma.shape[1]] for start in (0, 1))
    if blue.shape != luma.shape or red.shape != luma.shape:  # an odd width: the last pixel lacks one
        blue, red = (np.resize(part, luma.shape) for part in (blue, red))
    return np.array(Image.merge("YCbCr", [Image.fromarray(p) for p in (luma, blue, red)]).convert("RGB"))


def demosaiced(mosaic: Bytes, pattern: str) -> Bytes:
    """RGB of a Bayer mosaic (H, W): each colour's missing pixels are the mean of its neighbours'.

    Args:
        mosaic: (H, W).
        pattern: of the top left four pixels, as `rggb`.
    """
    row, column = RED_AT[pattern]
    v, u = np.indices(mosaic.shape)
    red = (v % 2 == row) & (u % 2 == column)
    blue = (v % 2 != row) & (u % 2 != column)
    planes = [_filled(mosaic, where) for where in (red, ~(red | blue), blue)]
    return np.stack(planes, axis=-1)


def _filled(mosaic: Bytes, known: NDArray[np.bool_]) -> Bytes:
    values, weights = np.where(known, mosaic, 0).astype(np.float32), known.astype(np.float32)
    total, count = _around(values), _around(weights)
    mean = total / np.maximum(count, 1e-6)
    return np.where(known, mosaic, np.round(mean)).astype(np.uint8)


def _around(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """The sum of each pixel's 3x3 neighbourhood, nearer ones twice or four times (bilinear)."""
    for axis in (0, 1):
        wide = np.pad(values, [(1, 1) if one == axis else (0, 0) for one in (0, 1)])
        length = values.shape[axis]
        before, middle, after = (np.take(wide, np.arange(k, k + length), axis) for k in range(3))
        values = before + 2 * middle + after
    return values
