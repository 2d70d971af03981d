"""What rosbag2 packs with zstd: whole files, or each message by itself."""

import shutil
from pathlib import Path
from typing import Any

ZSTD = b"\x28\xb5\x2f\xfd"
LARGEST_MESSAGE = 1 << 28
"""Bytes; a damaged length must not take all memory."""


def unpack_file(file: Path, folder: Path) -> Path:
    """A copy in a folder, without the compression and its suffix."""
    target = folder / file.stem
    with _zstd().open(file, "rb") as packed, target.open("wb") as plain:
        shutil.copyfileobj(packed, plain)
    return target


def unpacked(payload: bytes) -> bytes:
    """The payload of a message, without the zstd that rosbag2 may put around each by itself.

    Only metadata.yaml says that it did; but no payload in CDR begins with zstd's first four bytes.
    """
    if not payload.startswith(ZSTD):
        return payload
    plain: bytes = _zstd().ZstdDecompressor().decompress(payload, LARGEST_MESSAGE)
    return plain


def _zstd() -> Any:
    try:
        from compression import zstd  # type: ignore[import-not-found, unused-ignore]
    except ImportError:
        from backports import zstd
    return zstd
