"""Replay: a bounded memory of past training frames."""

import numpy as np

from horizon_dl.learning.crops import TrainingFrame


class ReplayMemory:
    """A uniform random sample of all frames seen so far, at most `memory_mb` MiB of them.

    Source: Vitter, Random sampling with a reservoir, 1985 (algorithm R).
    """

    def __init__(self, memory_mb: float, rng: np.random.Generator) -> None:
        self._limit_bytes = memory_mb * 2**20
        self._rng = rng
        self._seen = 0
        self.frames: list[TrainingFrame] = []

    def add(self, frame: TrainingFrame) -> None:
        """Take a frame in, in the place of a random older one when the memory is full."""
        self._seen += 1
        if not self.frames or self.nbytes + frame.nbytes <= self._limit_bytes:
            self.frames.append(frame)
            return
        place = self._rng.integers(self._seen)
        if place < len(self.frames):
            self.frames[place] = frame

    def draw(self, count: int) -> list[TrainingFrame]:
        """`count` frames at random, with repetition."""
        return [self.frames[i] for i in self._rng.integers(len(self.frames), size=count)]

    @property
    def nbytes(self) -> int:
        """Bytes held."""
        return sum(frame.nbytes for frame in self.frames)
