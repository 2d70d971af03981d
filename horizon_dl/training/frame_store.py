"""Reading a recording for learning: what cannot be read is skipped and counted, memory is bounded."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
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
        learned: indices of those that a net learned from.
    """

    def __init__(self, recording: Recording, config: Config) -> None:
        self.recording = recording
        self.config = config
        self.skipped: dict[str, str] = {}
        self.learned: set[int] = set()
        self._tried: set[int] = set()

    def frames(self, indices: Iterable[int]) -> Iterator[tuple[Frame, View]]:
        """The usable frames among `indices`, read one at a time; InputError as `usable`."""
        return self.usable((index, self.read(index)) for index in indices)

    def views(self, indices: Iterable[int]) -> Iterator[View]:
        """As `frames`, without the full-size images."""
        return (view for _, view in self.frames(indices))

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
        """What was tried, skipped and learned from, for JSON."""
        sets = {"tried": sorted(self._tried), "learned": sorted(self.learned)}
        return {"skipped": dict(self.skipped), **sets}

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a `state`."""
        self.skipped.update(state["skipped"])
        self._tried.update(state["tried"])
        self.learned.update(state["learned"])

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
    """The training frames of a round: a random part of a recording, in bounded memory.

    Args:
        store: where frames come from.
        indices: which of them.
        make_frame: what is kept of a frame.
        most: frames that are enough.
        memory_mb: what the pool may hold.
        rng: random numbers; those of crops, too.
        progress: show a bar.
        title: stands before the bar, such as "round 1 of 3".
        held: of another pool, to hold the same frames again.

    Attributes:
        frames: what was made of them.
        held: their indices, in the same order.
    """

    def __init__(
        self,
        store: FrameStore,
        indices: Sequence[int],
        *,
        make_frame: Callable[[View], TrainingFrame],
        most: int,
        memory_mb: float,
        rng: np.random.Generator,
        progress: bool = False,
        title: str = "",
        held: Sequence[int] | None = None,
    ) -> None:
        self._rng = rng
        self.frames: list[TrainingFrame] = []
        self.held: list[int] = []
        order = rng.permutation(indices).tolist() if held is None else held
        numbered = store.usable((index, _numbered(store, index)) for index in order)
        bar = show_progress(
            islice(numbered, most),
            f"{title}, targets" if title else "targets",
            total=min(most, len(order)),
            unit="frame",
            disable=not progress,
        )
        free_bytes = memory_mb * 2**20
        for index, view in bar:
            self.frames.append(make_frame(view))
            self.held.append(index)
            store.learned.add(index)
            free_bytes -= self.frames[-1].nbytes
            if free_bytes < 0.0:
                break

    def draw(self, count: int) -> list[TrainingFrame]:
        """`count` frames at random; without repetition where the pool is large enough."""
        chosen = self._rng.choice(len(self.frames), count, replace=count > len(self.frames))
        return [self.frames[i] for i in chosen]


def _numbered(store: FrameStore, index: int) -> tuple[int, View] | FrameError:
    found = store.read(index)
    return found if isinstance(found, FrameError) else (index, found[1])
