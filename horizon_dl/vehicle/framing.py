"""Finds MAVLink's frames among bytes: damage costs no more than the messages it hits.

pymavlink's own parser leaves out, after a wrong checksum, as many bytes as the damaged header says, and may
begin anew in the midst of the next message. Where every message holds a byte that looks like a beginning, as
the time in a signature may for minutes, it then never finds back.
"""

from collections.abc import Callable
from typing import Any

VERSION_1, VERSION_2 = 0xFE, 0xFD
OVERHEAD = {VERSION_1: 8, VERSION_2: 12}
"""Bytes of a frame beside its payload: header and checksum."""
SIGNED, SIGNATURE_BYTES = 1, 13
MOST_TRIED = 500
"""Beginnings without a message, in the bytes of one look at the line; what follows them is left out."""

Decode = Callable[[bytearray], list[Any] | None]


class Framer:
    """Cuts a stream of bytes into frames, whatever stands between them.

    Example:
        >>> framer = Framer()
        >>> decode = lambda frame: [bytes(frame)] if frame.endswith(b"ok") else None
        >>> framer.take(bytes.fromhex("fefdfe0000000000") + b"ok" + b"\\xfd", decode)
        ([b'\\xfe\\x00\\x00\\x00\\x00\\x00ok'], 1)
        >>> framer.forget()
        True
    """

    def __init__(self) -> None:
        self._kept = b""
        self._known = 0

    def forget(self) -> bool:
        """Leave out what may be the beginning of a frame, where the next bytes do not continue it.

        Returns:
            Whether they were bytes of no frame; what only looks like a beginning, inside a whole frame of no
            use, is not.
        """
        unclear = self._known < len(self._kept)
        self._kept, self._known = b"", 0
        return unclear

    def take(self, content: bytes, decode: Decode) -> tuple[list[Any], int]:
        """What `decode` made of the frames that are whole now, and how many stretches of bytes were none.

        Args:
            content: the next bytes.
            decode: gives the messages of a frame; None for no frame; and nothing for one that may be whole,
                but is of no use: what it holds is searched as well.
        """
        data = self._kept + content
        found: list[Any] = []
        place = stretches = failed = 0
        known = self._known  # up to there it is clear what the bytes are
        waits: int | None = None
        while failed < MOST_TRIED and (place := _next_marker(data, place)) < len(data):
            end = place + _size(data, place)
            if end > len(data):  # a message behind it shows that this was none
                waits = place if waits is None else waits
                place += 1
                continue
            messages = decode(bytearray(data[place:end]))
            if messages:
                found += messages
                stretches += known < place
                known, place, waits = end, end, None
                continue
            failed += 1
            known = end if messages is not None and known == place else known
            place += 1
        kept = len(data) if waits is None or failed == MOST_TRIED else waits
        self._kept, self._known = data[kept:], max(0, known - kept)
        return found, stretches + (known < kept)


def _next_marker(data: bytes, place: int) -> int:
    """Where the next frame may begin; the length of the data for nowhere."""
    places = (data.find(marker, place) for marker in OVERHEAD)
    return min((one for one in places if one >= 0), default=len(data))


def _size(data: bytes, place: int) -> int:
    """Bytes of the frame that begins there, as far as its header has come."""
    header = data[place : place + 3]
    size = OVERHEAD[header[0]] + (header[1] if len(header) > 1 else 0)
    signed = header[0] == VERSION_2 and len(header) > 2 and header[2] & SIGNED
    return size + (SIGNATURE_BYTES if signed else 0)
