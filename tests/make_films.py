"""Writes small films of any kind, each frame with its number drawn as 8 black or white bars."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

BITS = 8


def picture(number: int, width: int = 64, height: int = 48) -> NDArray[np.uint8]:
    """The upper half is bars, bit 0 at the left; the lower half is grey, so that up is told from down."""
    image = np.full((height, width, 3), 128, np.uint8)
    for bit in range(BITS):
        bar = slice(bit * width // BITS, (bit + 1) * width // BITS)
        image[: height // 2, bar] = 255 if number >> bit & 1 else 0
    return image


def number_of(image: NDArray[np.uint8]) -> int:
    height, width = image.shape[:2]
    bars = image[: height // 2].mean(axis=(0, 2)).reshape(BITS, width // BITS).mean(axis=1)
    return sum((value > 128) << bit for bit, value in enumerate(bars.tolist()))


def film(
    path: Path,
    stamps_ms: Sequence[int],
    codec: str = "libx264",
    options: dict[str, str] | None = None,
    size: tuple[int, int] = (64, 48),
) -> Path:
    """A film of numbered frames; H.264 with B-frames unless told otherwise."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=30)
        stream.width, stream.height = size
        stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else "yuv420p"
        stream.codec_context.time_base = Fraction(1, 1000)
        if codec == "libx264":
            stream.options = {"bf": "3", "g": "12", "b-adapt": "0", "crf": "10", **(options or {})}
        for number, stamp in enumerate(stamps_ms):
            frame = av.VideoFrame.from_ndarray(picture(number, *size), format="rgb24")
            frame.pts, frame.time_base = stamp, Fraction(1, 1000)
            for packet in stream.encode(frame):
                container.mux(packet)
        for packet in stream.encode():
            container.mux(packet)
    return path
