"""How many bits pictures of more than 8 bits use: 10 and 12 often lie in files of 16.

The number holds for a whole recording: a scale of its own for every picture would make them flicker.
"""

import re
import struct
from collections.abc import Sequence
from pathlib import Path

from horizon_dl.data.decoding import decode, deep_values, is_deep
from horizon_dl.data.evenly import evenly
from horizon_dl.errors import FrameError

FULL = 16
DEPTHS = (8, 10, 12, 14, FULL)
LOOKED_AT = 16
PNG = b"\x89PNG\r\n\x1a\n"


def used_bits(paths: Sequence[Path]) -> int:
    """Bits that the pictures of a recording use, of 16; 16 where they have 8.

    A PNG says so itself (sBIT), a PGM is scaled by the largest value that it states, if that is not all 16
    bits; else the brightest pixel of some pictures over the recording tells.
    """
    brightest = 0
    for path in evenly(paths, LOOKED_AT):
        try:
            image = decode(path)
            if not is_deep(image) or _scaled_by_its_own(path):
                return FULL
            declared = _significant_bits(path)
            if declared:
                return max(8, min(declared, FULL))
            brightest = max(brightest, int(deep_values(path, image).max(initial=0)))
        except FrameError:
            continue
    if brightest == 0:
        return FULL
    return next(depth for depth in DEPTHS if brightest < 2**depth)


def _scaled_by_its_own(path: Path) -> bool:
    """Whether a PGM or PPM states a largest value under that of 16 bits: then Pillow has scaled it."""
    try:
        with path.open("rb") as file:
            head = file.read(2**12)
    except OSError:
        return False
    found = re.match(rb"P[2356](?:\s+|#[^\n]*\n)+\d+(?:\s+|#[^\n]*\n)+\d+(?:\s+|#[^\n]*\n)+(\d{1,5})\s", head)
    return found is not None and int(found[1]) < 2**FULL - 1


def _significant_bits(path: Path) -> int | None:
    """The largest number in a PNG's sBIT chunk, which lies before its pixels."""
    try:
        head = path.read_bytes()[: 2**14]
    except OSError:
        return None
    place = len(PNG)
    while head.startswith(PNG) and place + 8 <= len(head):
        length, kind = struct.unpack(">I4s", head[place : place + 8])
        if kind == b"sBIT" and length:
            return max(head[place + 8 : place + 8 + length])
        if kind == b"IDAT":
            return None
        place += 12 + length
    return None
