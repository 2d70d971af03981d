"""Training frames in little memory: image as JPEG, target and elevation as float16 at half the size.

Targets are kept exactly. Rounded to 1/254, those of sure floor become 0 and the AUC within depression bands
falls by .02 to .03; see docs/RESEARCH.md.
"""

import io
import zlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.training.crops import TrainingFrame
from horizon_dl.training.half_resolution import doubled

Map = NDArray[np.float32]

JPEG_QUALITY = 95


@dataclass(frozen=True)
class CompressedFrame:
    """A training frame of about an eighth to a fifth of its size.

    Attributes:
        image: JPEG file without colour subsampling, off by one or two grey levels.
        valid_mask: zlib stream of one bit a pixel.
        target: zlib stream of float16 at half the size, as differences along the rows.
        elevation: the same of the elevation, rad.
    """

    image: bytes
    valid_mask: bytes
    target: bytes
    elevation: bytes

    @property
    def nbytes(self) -> int:
        """Bytes held."""
        return len(self.image) + len(self.valid_mask) + len(self.target) + len(self.elevation)


def pack(frame: TrainingFrame, elevation: Map) -> CompressedFrame:
    """Compress a frame, whose target is one of half the size doubled, and its (h // 2, w // 2) elevation."""
    file = io.BytesIO()
    Image.fromarray(frame.image).save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0)
    valid_mask = zlib.compress(np.packbits(frame.valid_mask).tobytes(), level=1)
    return CompressedFrame(file.getvalue(), valid_mask, _pack_target(frame.target), _pack_halves(elevation))


def with_target(packed: CompressedFrame, target: NDArray[np.float16]) -> CompressedFrame:
    """The same frame with another (h, w) target."""
    return replace(packed, target=_pack_target(target))


def unpack(packed: CompressedFrame) -> TrainingFrame:
    """What was packed, but for what JPEG takes away; about 1 ms at 320x240."""
    image = np.asarray(Image.open(io.BytesIO(packed.image)))
    height, width = image.shape[:2]
    bits = np.frombuffer(zlib.decompress(packed.valid_mask), np.uint8)
    valid_mask = np.unpackbits(bits, count=height * width).reshape(height, width).astype(np.bool_)
    return TrainingFrame(image, doubled(_halves(packed.target, height, width), (height, width)), valid_mask)


def unpack_elevation(packed: CompressedFrame) -> Map:
    """The (h // 2, w // 2) elevation, rad, to about 1e-3 of itself."""
    width, height = Image.open(io.BytesIO(packed.image)).size
    return _halves(packed.elevation, height, width).astype(np.float32)


def _pack_target(target: NDArray[np.float16]) -> bytes:
    height, width = target.shape
    return _pack_halves(target[: height // 2 * 2 : 2, : width // 2 * 2 : 2])


def _pack_halves(values: NDArray[np.floating]) -> bytes:
    """Differences of the bits along the rows, modulo 2 ** 16: exact, and small where it is smooth."""
    bits = values.astype(np.float16).view(np.uint16)
    return zlib.compress(np.diff(bits, axis=1, prepend=np.uint16(0)).tobytes(), level=1)


def _halves(stream: bytes, height: int, width: int) -> NDArray[np.float16]:
    steps = np.frombuffer(zlib.decompress(stream), np.uint16).reshape(height // 2, width // 2)
    return np.cumsum(steps, axis=1, dtype=np.uint16).view(np.float16)
