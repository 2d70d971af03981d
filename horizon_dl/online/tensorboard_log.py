"""Curves for TensorBoard, written by the caller's thread: a full disk ends the curves and nothing else."""

import math
import time
from collections.abc import Mapping
from pathlib import Path

from tensorboard.compat.proto.event_pb2 import Event, SessionLog  # type: ignore[import-untyped]
from tensorboard.compat.proto.summary_pb2 import Summary  # type: ignore[import-untyped]
from tensorboard.summary.writer.record_writer import RecordWriter  # type: ignore[import-untyped]

FLUSH_EVERY_S = 10.0


class TensorBoardLog:
    """One event file; values from its position on that a killed run left in an earlier file are hidden."""

    def __init__(self, folder: Path, position: int) -> None:
        """Create the file.

        Raises:
            OSError: the folder cannot be written.
        """
        folder.mkdir(exist_ok=True)
        name = f"events.out.tfevents.{time.time_ns() // 1_000_000_000:010d}.{time.time_ns()}"
        self._writer: RecordWriter | None = RecordWriter((folder / name).open("wb"))
        self._flushed_s = time.monotonic()
        self._write(Event(wall_time=time.time(), file_version="brain.Event:2"))
        start = SessionLog(status=SessionLog.START)
        self._write(Event(wall_time=time.time(), step=position, session_log=start))

    def add(self, values: Mapping[str, float], step: int) -> None:
        """A point of every curve; what is not finite is left out."""
        points = [
            Summary.Value(tag=name, simple_value=value)
            for name, value in values.items()
            if math.isfinite(value)
        ]
        self._write(Event(wall_time=time.time(), step=step, summary=Summary(value=points)))

    def close(self) -> None:
        """Close the file."""
        self._guarded("close")

    def _write(self, event: Event) -> None:
        self._guarded("write", event.SerializeToString())
        if time.monotonic() - self._flushed_s > FLUSH_EVERY_S:
            self._flushed_s = time.monotonic()
            self._guarded("flush")

    def _guarded(self, action: str, *arguments: bytes) -> None:
        try:
            if self._writer is not None:
                getattr(self._writer, action)(*arguments)
        except OSError:
            self._writer = None
