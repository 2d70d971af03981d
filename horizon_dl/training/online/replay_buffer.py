"""Replay: a bounded memory of past training frames."""

import heapq
import math
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields, replace
from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.evenly import evenly
from horizon_dl.training.checkpoint import Snapshot
from horizon_dl.training.crops import TrainingFrame
from horizon_dl.training.online.compression import (
    CompressedFrame,
    pack,
    unpack,
    unpack_elevation,
    with_target,
)

Map = NDArray[np.float32]

SKETCH = (16, 12)
"""Width and height of the small pictures by which frames are compared."""
NEW_LEVELS = 4.0
"""A frame that differs from the one before it by this many grey levels in the mean is wholly new."""
LEAST_WEIGHT = 0.05
"""A frame just like the one before it is this likely to be kept, compared with a new one."""


@dataclass(frozen=True, order=True)
class _Kept:
    """A frame, its place in the queue for being forgotten (keys do not repeat), and the age of its target."""

    key: float
    number: int
    packed: CompressedFrame
    made_at: int


class ReplayBuffer:
    """A random sample of all frames seen so far, compressed, at most `memory_mb` MiB of them.

    All of a changing stream is remembered evenly. What does not change (the robot stands still) is remembered
    less, so that a long pause does not push out all that was before it. At least one frame is kept.

    Source: Efraimidis and Spirakis, Weighted random sampling with a reservoir, 2006 (A-ES): a frame of weight
    w has the key `log(u) / w`, u uniform in (0, 1], and the largest keys stay.
    """

    def __init__(self, memory_mb: float, rng: np.random.Generator) -> None:
        self._limit_bytes = memory_mb * 2**20
        self._rng = rng
        self._kept: list[_Kept] = []
        self._sketch: NDArray[np.uint8] | None = None
        self.seen = 0
        self.nbytes = 0

    def __len__(self) -> int:
        return len(self._kept)

    def add(self, frame: TrainingFrame, elevation: Map, made_at: int) -> None:
        """Take a frame in; those that then are too much, this one perhaps among them, are forgotten.

        Args:
            frame: to be replayed.
            elevation: (h // 2, w // 2) rad.
            made_at: how much the net that guided its target had seen; any unit.
        """
        weight = self._weight(frame.image)
        key = math.log(1.0 - self._rng.random()) / weight
        kept = _Kept(key, self.seen, pack(frame, elevation), made_at)
        heapq.heappush(self._kept, kept)
        self.seen += 1
        self.nbytes += kept.packed.nbytes
        self._forget()

    def renew(self, now: int, target_of: Callable[[NDArray[np.uint8], Map], NDArray[np.float16]]) -> None:
        """Make the target anew that was made the longest time ago: its net knew less.

        Args:
            now: as `made_at`; nothing is done where all targets are of now.
            target_of: gives the (h, w) target of an image and its (h // 2, w // 2) elevation.
        """
        place = min(range(len(self._kept)), key=lambda index: self._kept[index].made_at)
        kept = self._kept[place]
        if kept.made_at < now:
            target = target_of(unpack(kept.packed).image, unpack_elevation(kept.packed))
            packed = with_target(kept.packed, target)
            self.nbytes += packed.nbytes - kept.packed.nbytes
            self._kept[place] = replace(kept, packed=packed, made_at=now)
            self._forget()

    def draw(self, count: int) -> list[TrainingFrame]:
        """`count` frames at random, with repetition."""
        return [unpack(self._kept[i].packed) for i in self._rng.integers(len(self._kept), size=count)]

    def sample(self, count: int) -> list[CompressedFrame]:
        """At most `count` of the frames held, evenly spread over the time since the first."""
        by_time = sorted(self._kept, key=lambda kept: kept.number)
        return [kept.packed for kept in evenly(by_time, count)]

    def numbers(self) -> list[int]:
        """Of each frame held, how many were seen before it."""
        return [kept.number for kept in self._kept]

    def snapshot(self) -> Snapshot:
        """All that is held, but for the random state."""
        blobs = [blob for kept in self._kept for blob in astuple(kept.packed)]
        sketch = np.zeros(0, np.uint8) if self._sketch is None else self._sketch
        tensors = {
            "blobs": torch.from_numpy(np.frombuffer(b"".join(blobs) or b"\0", np.uint8).copy()),
            "sketch": torch.from_numpy(sketch.copy()),
        }
        values = {
            "keys": [kept.key for kept in self._kept],
            "numbers": self.numbers(),
            "made_at": [kept.made_at for kept in self._kept],
            "lengths": [len(blob) for blob in blobs],
            "seen": self.seen,
        }
        return Snapshot(tensors, values)

    def restore(self, snapshot: Snapshot) -> None:
        """Hold what a snapshot holds."""
        values, content = snapshot.values, snapshot.tensors["blobs"].numpy().tobytes()
        ends = np.cumsum([0, *values["lengths"]])
        blobs = [content[start:end] for start, end in pairwise(ends)]
        parts = len(fields(CompressedFrame))
        packed = [CompressedFrame(*blobs[first : first + parts]) for first in range(0, len(blobs), parts)]
        columns = (values["keys"], values["numbers"], packed, values["made_at"])
        self._kept = [_Kept(*one) for one in zip(*columns, strict=True)]
        self.nbytes = sum(one.nbytes for one in packed)
        self.seen = values["seen"]
        sketch = snapshot.tensors["sketch"].numpy()
        self._sketch = sketch if sketch.size else None

    def _forget(self) -> None:
        """Down to the limit; a target made anew may pack worse than the old one."""
        while self.nbytes > self._limit_bytes and len(self._kept) > 1:
            self.nbytes -= heapq.heappop(self._kept).packed.nbytes

    def _weight(self, image: NDArray[np.uint8]) -> float:
        sketch = np.asarray(Image.fromarray(image).resize(SKETCH, Image.Resampling.BOX))
        before, self._sketch = self._sketch, sketch
        if before is None:
            return 1.0
        change = float(np.abs(sketch.astype(np.int16) - before.astype(np.int16)).mean())
        return min(1.0, max(LEAST_WEIGHT, change / NEW_LEVELS))
