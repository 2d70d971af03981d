"""GoPro's metadata (GPMF): keys, lengths and values, walked without any library.

An item is a key of four letters, a type, the size of one structure, their number (big-endian), and the
values, filled up to four bytes. Type 0 holds further items. A device (DEVC) holds streams (STRM); a stream
holds how its last item, the samples, is to be read: SCAL divides them, TYPE gives the types of mixed ones.
"""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

HEAD = struct.Struct(">4sBBH")
NUMBERS = {
    "b": "b", "B": "B", "s": "h", "S": "H", "l": "i", "L": "I", "f": "f", "d": "d", "j": "q", "J": "Q",
    "q": "i", "Q": "q",
}  # fmt: skip
"""Types of numbers in the terms of `struct`; q and Q are fixed-point."""
FIXED_POINT = {"q": 2.0**-16, "Q": 2.0**-32}


@dataclass(frozen=True)
class Item:
    """One key with its raw values.

    Attributes:
        key: four letters.
        kind: the type's letter; empty where further items are inside.
        size: bytes of one structure.
        count: number of structures.
        data: their bytes.
    """

    key: str
    kind: str
    size: int
    count: int
    data: bytes


def items(data: bytes) -> Iterator[Item]:
    """The items side by side in some bytes; what is cut off at the end is left out."""
    place = 0
    while place + HEAD.size <= len(data):
        key, kind, size, count = HEAD.unpack_from(data, place)
        length = size * count
        place += HEAD.size
        if key == b"\0\0\0\0" or place + length > len(data):
            return
        letter = chr(kind) if kind else ""
        yield Item(key.decode("latin-1"), letter, size, count, data[place : place + length])
        place += -(-length // 4) * 4


def streams(data: bytes) -> Iterator[dict[str, Item]]:
    """The items of every stream of every device, by their keys."""
    for device in items(data):
        if device.key == "DEVC":
            for stream in items(device.data):
                if stream.key == "STRM":
                    yield {item.key: item for item in items(stream.data)}


def numbers(item: Item, types: str = "") -> Floats:
    """The values as (count, elements); no rows where they are no numbers.

    Args:
        item: of a stream.
        types: of mixed structures ("?"), one letter an element.
    """
    kinds = types if item.kind == "?" else item.kind
    if not kinds or any(kind not in NUMBERS for kind in kinds):
        return np.empty((0, 0))
    if item.kind != "?":
        kinds *= max(1, item.size // struct.calcsize(">" + NUMBERS[item.kind]))
    layout = struct.Struct(">" + "".join(NUMBERS[kind] for kind in kinds))
    if layout.size != item.size:
        return np.empty((0, 0))
    rows = [layout.unpack_from(item.data, index * item.size) for index in range(item.count)]
    factors = [FIXED_POINT.get(kind, 1.0) for kind in kinds]
    return np.array(rows, np.float64).reshape(item.count, len(kinds)) * factors


def samples(stream: dict[str, Item], key: str) -> Floats:
    """A stream's samples (n, elements) in the units that it states."""
    types = text(stream, "TYPE")
    values = numbers(stream[key], types)
    scale = numbers(stream["SCAL"]).ravel() if "SCAL" in stream else np.ones(1)
    if not len(values) or len(scale) not in (1, values.shape[1]) or not scale.all():
        return np.empty((0, 0))
    return np.asarray(values / scale)


def text(stream: dict[str, Item], key: str) -> str:
    """An item's letters; empty where there is none."""
    return stream[key].data.decode("latin-1").rstrip("\0 ") if key in stream else ""


def spread(starts_s: Sequence[float], counts: Sequence[int], end_s: float) -> Floats:
    """Times of samples that come in packets, evenly from the start of one to that of the next, s.

    Example:
        >>> spread([0.0, 1.0], [2, 4], 2.0).tolist()
        [0.0, 0.5, 1.0, 1.25, 1.5, 1.75]
    """
    edges = [*starts_s, end_s]
    parts = [
        start + (end - start) * np.arange(count) / count
        for start, end, count in zip(edges, edges[1:], counts, strict=False)
        if count
    ]
    return np.concatenate(parts) if parts else np.empty(0)
