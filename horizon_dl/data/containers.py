"""Opens films and what else a container holds, by PyAV."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from horizon_dl.errors import InputError

DAMAGED = (OSError, ValueError, ArithmeticError, LookupError, RuntimeError, MemoryError)
"""What libraries raise on a damaged file; FFmpeg's errors are all one of these."""
MOST_ERRORS = 20
"""Damaged places in a container after which it is given up."""
MOST_BOXES = 100


def opened(path: Path) -> Any:
    """An open container; close it, or use it in `with`.

    Raises:
        InputError: PyAV is missing, the file is no container, or it has no film.
    """
    try:
        import av
    except ImportError:
        raise InputError(path, "is a film", "install horizon-dl[logs] to read it") from None
    # What is damaged is told in our words. Never a level: a decoding thread that logs would wait for Python's
    # lock, which is held while a container is closed.
    av.logging.set_level(None)
    try:
        container = av.open(str(path))
    except (av.error.FFmpegError, OSError, ValueError):
        if _has_no_index(path):
            hint = "mend it with the camera that took it, or with a tool as untrunc"
            raise InputError(
                path, "is no film yet: it was cut off before its index was written", hint
            ) from None
        raise InputError(path, "is no film that can be read", "convert it to MP4 with H.264") from None
    if not container.streams.video:
        container.close()
        raise InputError(path, "holds no film", "give a file with a video track")
    return container


def packets(container: Any, stream: Any) -> Iterator[Any]:
    """Packets of a stream as far as the container can be read."""
    for _ in range(MOST_ERRORS):
        try:
            yield from container.demux(stream)
            return
        except DAMAGED:
            continue  # behind the damage


def frames_of(packet: Any) -> list[Any]:
    """The frames of a packet; none of a damaged one."""
    try:
        return list(packet.decode())
    except DAMAGED:
        return []


def first_frame(path: Path) -> Any:
    """The first frame that can be decoded.

    Raises:
        InputError: there is none, or it is no film.
    """
    with opened(path) as container:
        film = packets(container, container.streams.video[0])
        frame = next((frame for packet in film for frame in frames_of(packet)), None)
    if frame is None:
        raise InputError(path, "holds no frame that can be decoded", "record again")
    return frame


def _has_no_index(path: Path) -> bool:
    """Whether a file begins as an MP4 or QuickTime film, and its box `moov` is not there."""
    try:
        with path.open("rb") as file:
            kinds: list[bytes] = []
            end = path.stat().st_size
            while len(kinds) < MOST_BOXES and len(head := file.read(8)) == 8:
                size, kind = int.from_bytes(head[:4], "big"), head[4:]
                size = int.from_bytes(file.read(8), "big") - 8 if size == 1 else size
                kinds.append(kind)
                if not 8 <= size <= end:
                    break
                file.seek(size - 8, 1)
    except OSError:
        return False
    return kinds[:1] == [b"ftyp"] and b"mdat" in kinds and b"moov" not in kinds
