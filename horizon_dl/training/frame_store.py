"""Reading a recording for learning: what cannot be read is skipped and counted, memory is bounded."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, TypeVar

import numpy as np

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View, make_view
from horizon_dl.errors import FrameError, InputError
from horizon_dl.progress import show_progress
from horizon_dl.training.crops import TrainingFrame

T = TypeVar("T")

MOST_SKIPPED = 0.2
LEAST_TRIED = 10


class FrameStore:
    """Frames of a recording by index, with a summary of those that had to be skipped.

    Attributes:
        skipped: reason by frame name.
    """

    def __init__(self, recording: Recording, config: Config) -> None:
        self.recording = recording
        self.config = config
        self.skipped: dict[str, str] = {}
        self._tried: set[int] = set()

    def frames(self, indices: Iterable[int]) -> Iterator[tuple[Frame, View]]:
        """The usable frames among `indices`, read one at a time; InputError as `usable`."""
        return self.usable((index, self.read(index)) for index in indices)

    def read(self, index: int) -> tuple[Frame, View] | FrameError:
        """One frame, or why it cannot be used."""
        try:
            frame = self.recording.read(index)
            return frame, make_view(frame, self.config.image.max_pixels)
        except FrameError as error:
            return error

    def usable(self, results: Iterable[tuple[int, T | FrameError]]) -> Iterator[T]:
        """What became of frames by index, without those that cannot be used, which are counted.

        Raises:
            InputError: more than a fifth of at least ten frames, or all of fewer, cannot be used.
        """
        for index, result in results:
            self._tried.add(index)
            if isinstance(result, FrameError):
                self.skipped[self.recording.headers[index].name] = str(result)
                self._stop_if_too_many()
            else:
                yield result
        if self._tried and len(self.skipped) >= len(self._tried):
            self._complain()

    def state(self) -> dict[str, Any]:
        """What was tried and skipped, for JSON."""
        return {"skipped": dict(self.skipped), "tried": sorted(self._tried)}

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a `state`."""
        self.skipped.update(state["skipped"])
        self._tried.update(state["tried"])

    def views(self, indices: Iterable[int]) -> Iterator[View]:
        """The same, without the full-size frames."""
        return (view for _, view in self.frames(indices))

    def _stop_if_too_many(self) -> None:
        if len(self._tried) >= LEAST_TRIED and len(self.skipped) > MOST_SKIPPED * len(self._tried):
            self._complain()

    def _complain(self) -> None:
        first = next(iter(self.skipped.values()))
        raise InputError(
            self.recording.name,
            f"{len(self.skipped)} of {len(self._tried)} frames cannot be used (the first: {first})",
            "see `horizon-dl check-data` for all of them",
        )


class FramePool:
    """Training frames in bounded memory.

    Sets that fit are held whole. Of larger ones the pool holds a random part, and every draw exchanges one
    frame of it for the next one not held.

    Args:
        store: where frames come from.
        indices: which of them.
        make_frame: what is kept of a frame.
        memory_mb: what the pool may hold.
        rng: random numbers; those of crops, too.
        progress: show a bar.
        title: stands before the bar, such as "round 1 of 3".
        state: of `state`, to hold the same frames again.
    """

    def __init__(
        self,
        store: FrameStore,
        indices: Sequence[int],
        *,
        make_frame: Callable[[View], TrainingFrame],
        memory_mb: int,
        rng: np.random.Generator,
        progress: bool = False,
        title: str = "",
        state: dict[str, Any] | None = None,
    ) -> None:
        self._store = store
        self._make_frame = make_frame
        self._indices = indices
        self._rng = rng
        self.frames: list[TrainingFrame] = []
        self._held: list[int] = []
        self._waiting: list[int] = []
        self.complete = False
        self._bar = f"{title}, targets" if title else "targets"
        if state is None:
            order = [int(index) for index in rng.permutation(indices)]
            self.complete = self._fill(order, memory_mb * 2**20, progress)
        else:
            self._fill(state["held"], None, progress)
            self._waiting, self.complete = list(state["waiting"]), bool(state["complete"])

    def draw(self, count: int) -> list[TrainingFrame]:
        """`count` frames at random; without repetition where the pool is large enough."""
        if not self.complete:
            index, frame = self._next()
            place = int(self._rng.integers(len(self.frames)))
            self.frames[place], self._held[place] = frame, index
        chosen = self._rng.choice(len(self.frames), count, replace=count > len(self.frames))
        return [self.frames[i] for i in chosen]

    def state(self) -> dict[str, Any]:
        """Which frames are held and which come next, for JSON."""
        return {"held": list(self._held), "waiting": list(self._waiting), "complete": self.complete}

    def _fill(self, order: Sequence[int], limit_bytes: int | None, progress: bool) -> bool:
        """Whether all fit."""
        held = 0
        numbered = self._store.usable((index, self._numbered(index)) for index in order)
        bar = show_progress(numbered, self._bar, total=len(order), unit="frame", disable=not progress)
        for index, view in bar:
            self.frames.append(self._make_frame(view))
            self._held.append(index)
            held += self.frames[-1].nbytes
            if limit_bytes is not None and held > limit_bytes:
                return False
        return True

    def _next(self) -> tuple[int, TrainingFrame]:
        while True:
            if not self._waiting:
                self._waiting = [int(index) for index in self._rng.permutation(self._indices)]
            index = self._waiting.pop(0)
            for _, view in self._store.usable([(index, self._numbered(index))]):
                return index, self._make_frame(view)

    def _numbered(self, index: int) -> tuple[int, View] | FrameError:
        found = self._store.read(index)
        return found if isinstance(found, FrameError) else (index, found[1])
