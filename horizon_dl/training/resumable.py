"""Offline training that can be stopped, or killed, at any step and goes on to the same weights."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from torch import Tensor

from horizon_dl.config import Config
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.output.folder import claim_folder
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint

KIND, CHECKPOINT = "train", "checkpoint.safetensors"
EVERY_S = 60.0
ANEW = "start anew with --overwrite, or give another --out"


class TrainingStopped(KeyboardInterrupt):
    """Training was asked to stop, and has written its checkpoint."""


@dataclass(frozen=True)
class RoundState:
    """Where training is: in which round, after how many of its steps.

    Attributes:
        number: of the round, from 0; that of the rounds where all are done.
        step: steps taken in it.
        tensors: net and guide at least; see `HorizonModule.snapshot` for what comes within a round.
        values: random numbers, the frames held and those skipped.
    """

    number: int
    step: int
    tensors: dict[str, Tensor] = field(default_factory=dict)
    values: dict[str, Any] = field(default_factory=dict)


class TrainingKeeper:
    """Writes checkpoints of a training into its folder, from time to time and when it is to stop.

    Attributes:
        found: what to go on from, or None.
        stopped: end after the step at work.
    """

    def __init__(
        self,
        folder: Path,
        recording: Recording,
        config: Config,
        *,
        resume: bool = False,
        overwrite: bool = False,
        every_s: float = EVERY_S,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Read the checkpoint where one is asked for.

        Raises:
            InputError: there is none, or it is damaged or of another training.
        """
        self.stopped = False
        self._folder, self._overwrite = folder, overwrite or resume
        self._every_s, self._clock, self._last_s = every_s, clock, clock()
        self._identity = {
            "data": recording.name,
            "frames": recording.length,
            "config": config.model_dump(mode="json"),
        }
        self.found = self._read() if resume else None
        self._start_s = clock() - (self.found.values["train_s"] if self.found else 0.0)

    def stop(self) -> None:
        """End after the step at work; from any thread or a signal."""
        self.stopped = True

    @property
    def train_s(self) -> float:
        """Time spent so far, with that before the last stop."""
        return self._clock() - self._start_s

    def due(self) -> bool:
        """Whether it is time for a checkpoint."""
        return self.stopped or self._clock() - self._last_s >= self._every_s

    def save(self, state: RoundState) -> None:
        """Write a checkpoint, and end there if that was asked for.

        Raises:
            InputError: the folder cannot be written, or is not this training's.
            TrainingStopped: `stop` was called.
        """
        place = {**self._identity, "round": state.number, "step": state.step}
        values = {"place": place, "train_s": self.train_s, **state.values}
        try:
            claim_folder(self._folder, KIND, overwrite=self._overwrite)
            write_checkpoint(self._folder / CHECKPOINT, Snapshot(state.tensors, values))
        except OSError as error:
            problem = f"cannot be written ({error.strerror or error})"
            raise InputError(self._folder, problem, "make room there, then go on with --resume") from None
        self._overwrite = True  # from now on it is this training's
        self._last_s = self._clock()

    def check_stop(self) -> None:
        """Raise TrainingStopped where that was asked for."""
        if self.stopped:
            raise TrainingStopped(f"stopped; the same command with --resume goes on in {self._folder}")

    def finish(self) -> None:
        """The results are written: the checkpoint goes."""
        (self._folder / CHECKPOINT).unlink(missing_ok=True)

    def _read(self) -> RoundState:
        path = self._folder / CHECKPOINT
        if not path.is_file():
            raise InputError(
                self._folder, "holds no checkpoint of a training to go on from", "leave --resume away"
            )
        found = read_checkpoint(path, ANEW)
        values: dict[str, Any] = dict(found.values)
        try:
            place = values["place"]
            for name, own in self._identity.items():
                if place[name] != own:
                    problem = f"holds the checkpoint of a training with other {name}"
                    raise InputError(self._folder, problem, ANEW)
            return RoundState(int(place["round"]), int(place["step"]), found.tensors, values)
        except (KeyError, TypeError, ValueError):
            raise InputError(path, "is of something else than `train`", ANEW) from None
