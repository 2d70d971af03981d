"""Training frames in little memory: the image as JPEG, target and mask as one compressed byte a pixel."""

import io
import zlib
from dataclasses import dataclass

import numpy as np
from PIL import Image

from horizon_dl.learning.crops import TrainingFrame

JPEG_QUALITY = 95
TARGET_STEPS = 254
"""Targets are kept to 1/254; the byte 255 says that the pixel does not count."""
IGNORED = 255

_TARGET_OF_BYTE = (np.arange(256) / TARGET_STEPS).astype(np.float16)
_TARGET_OF_BYTE[IGNORED] = 0


@dataclass(frozen=True)
class PackedFrame:
    """A training frame of about a seventh of its size.

    Attributes:
        image: JPEG file without colour subsampling, off by one or two grey levels.
        labels: zlib stream of one byte a pixel.
    """

    image: bytes
    labels: bytes

    @property
    def nbytes(self) -> int:
        """Bytes held."""
        return len(self.image) + len(self.labels)


def pack(frame: TrainingFrame) -> PackedFrame:
    """Compress; takes about 1.5 ms at 320x240."""
    file = io.BytesIO()
    Image.fromarray(frame.image).save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0)
    steps = np.rint(frame.target.astype(np.float32) * TARGET_STEPS).astype(np.uint8)
    labels = np.where(frame.counts, steps, np.uint8(IGNORED))
    return PackedFrame(file.getvalue(), zlib.compress(labels.tobytes(), level=1))


def unpack(packed: PackedFrame) -> TrainingFrame:
    """What was packed, targets to 1/254 and images to the loss of JPEG; about 1 ms at 320x240."""
    image = np.asarray(Image.open(io.BytesIO(packed.image)))
    labels = np.frombuffer(zlib.decompress(packed.labels), np.uint8).reshape(image.shape[:2])
    return TrainingFrame(image, _TARGET_OF_BYTE[labels], labels != IGNORED)
