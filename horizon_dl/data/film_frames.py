"""Decodes a film's frames at any place: exact time stamps, upright as players show them, in flat memory."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.containers import DAMAGED, frames_of, opened, packets
from horizon_dl.data.decoding import MOST_PIXELS
from horizon_dl.data.source import Pixels
from horizon_dl.errors import FrameError, InputError

FORWARD = 30
"""Frames that are decoded on the way to a later one; further ones are sought."""
BACKWARD_S = (0.0, 1.0, 5.0, float("inf"))
"""How much before a frame the search for its key frame begins; containers' indices are not always right."""


def time_stamps(path: Path) -> tuple[list[int], list[float]]:
    """Presentation time stamps in the container's own unit, sorted, and seconds since the first one.

    Raises:
        InputError: the file holds no film.
    """
    with opened(path) as container:
        stream = container.streams.video[0]
        shown, decoded = set(), set()
        for packet in packets(container, stream):
            if packet.size and not packet.is_discard:
                shown.add(packet.pts)
                decoded.add(packet.dts)
        # Some containers (AVI) have no presentation times; then frames are in the order of decoding.
        stamps = sorted(stamp for stamp in (decoded if None in shown else shown) if stamp is not None)
        unit_s = float(stream.time_base)
    if not stamps:
        raise InputError(path, "holds no frames", "copy it again")
    return stamps, [(stamp - stamps[0]) * unit_s for stamp in stamps]


@dataclass
class FilmLoader:
    """Decodes frames of a film, forward from where it stands, else from the key frame before.

    Attributes:
        path: of the film.
        stamps: presentation time stamps of the frames.
        rotate_quarter_turns_ccw: how an image, as a player shows it, is turned to be upright.
    """

    path: Path
    stamps: tuple[int, ...]
    rotate_quarter_turns_ccw: int = 0
    _frames: Iterator[Any] | None = field(default=None, repr=False)
    _ahead: Any = field(default=None, repr=False)
    _next: int = 0

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        """See `Loader`."""
        frame = self._found(index)
        if frame is None:
            raise FrameError(
                self.path, f"frame {index} cannot be decoded", "copy the film again, or go on without"
            )
        turns = self.rotate_quarter_turns_ccw + round((frame.rotation or 0) / 90)
        return Pixels(np.ascontiguousarray(np.rot90(_rgb(frame), turns)))

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_frames": None, "_ahead": None}

    def _found(self, index: int) -> Any:
        """The decoded frame, or None."""
        target = self.stamps[index]
        if self._frames is not None and self._next <= index < self._next + FORWARD:
            return self._forward_to(index)
        for before_s in BACKWARD_S:
            self._frames, self._ahead = _decoded(self.path, target, before_s), None
            first = next(self._frames, None)
            if first is None:
                continue
            if first.pts <= target or before_s == BACKWARD_S[-1]:
                self._ahead = first
                return self._forward_to(index)
        self._frames = None
        return None

    def _forward_to(self, index: int) -> Any:
        """Decodes up to the frame; one that comes in place of it is kept for its own turn."""
        target = self.stamps[index]
        self._next = index + 1
        frame = self._ahead
        while frame is None or frame.pts < target:
            frame = next(self._frames, None) if self._frames is not None else None
            if frame is None:
                self._ahead = None
                return None
        self._ahead = frame if frame.pts > target else None
        return frame if frame.pts == target and not frame.is_corrupt else None


def _decoded(path: Path, stamp: int, before_s: float) -> Iterator[Any]:
    """Decoded frames from the key frame before a time stamp on; those that cannot be decoded are left out."""
    try:
        container = opened(path)
    except InputError as error:
        raise FrameError(*error.args) from None
    with container:
        stream = container.streams.video[0]
        stream.thread_type = "AUTO"
        if before_s < float("inf"):
            start = stream.start_time or 0
            _seek(container, stream, max(start, stamp - int(before_s / stream.time_base)))
        for packet in packets(container, stream):
            for frame in frames_of(packet):
                if frame.pts is None:
                    frame.pts = frame.dts
                if frame.pts is not None and frame.width * frame.height <= MOST_PIXELS:
                    yield frame


def _seek(container: Any, stream: Any, stamp: int) -> None:
    try:
        container.seek(stamp, stream=stream)
    except DAMAGED:
        return  # without an index: from the start


def _rgb(frame: Any) -> NDArray[np.uint8]:
    image: NDArray[np.uint8] = frame.to_ndarray(format="rgb24")
    return image
