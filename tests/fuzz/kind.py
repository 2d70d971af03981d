"""What a target is, and files that are damaged in place and put back."""

import os
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fuzz.mutations import bomb, damaged
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.errors import FrameError
from horizon_dl.readers.registry import open_recording

Case = Callable[[random.Random], None]
TEXT = {".csv", ".txt", ".yaml", ".json", ".srt", ".log"}


@dataclass(frozen=True)
class Target:
    """A kind of input.

    Attributes:
        name: for reports.
        share: of all cases.
        prepare: makes the material; what it gives makes and reads one input, and anything but the documented
            errors that that raises is a fault.
    """

    name: str
    share: float
    prepare: Callable[[], Case]


def reader(folder: Path, make: Callable[[Path], Path], given: Given = NOTHING_GIVEN) -> Case:
    """A recording of one format: its texts, or now and then any of its files, are damaged."""
    where = make(folder)
    whole = _files(folder)
    texts = sorted(name for name in whole if Path(name).suffix in TEXT) or sorted(whole)

    def case(chance: random.Random) -> None:
        changed = _damage_files(folder, whole, texts if chance.random() < 0.9 else sorted(whole), chance)
        try:
            recording = open_recording(where, given=given)
            for index, frame in enumerate(recording.frames()):
                if not isinstance(frame, FrameError):
                    assert frame.up_cam is None or abs(np.linalg.norm(frame.up_cam) - 1) < 1e-6
                if index == 1:
                    break
        finally:
            put_back(folder, whole, changed)

    return case


def _damage_files(
    folder: Path, whole: dict[str, bytes], names: list[str], chance: random.Random
) -> list[str]:
    """One or two files are damaged, lost, or made no files at all; their names."""
    changed = chance.sample(names, min(len(names), chance.choice((1, 1, 1, 2))))
    for name in changed:
        path = folder / name
        fate = chance.random()
        if fate < 0.03:
            path.unlink()
            os.mkfifo(path)
        elif fate < 0.05:
            path.unlink()
        elif fate < 0.08 and path.suffix == ".yaml":
            path.write_text(bomb(chance))
        else:
            path.write_bytes(damaged(whole[name], chance))
    return changed


def put_back(folder: Path, whole: dict[str, bytes], names: list[str]) -> None:
    """The files as they were."""
    for name in names:
        path = folder / name
        path.unlink(missing_ok=True)
        path.write_bytes(whole[name])


def _files(folder: Path) -> dict[str, bytes]:
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}
