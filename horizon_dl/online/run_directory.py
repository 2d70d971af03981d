"""The folder of an online run while it runs: checkpoint, one line a frame, TensorBoard logs."""

import sys
import time
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout
from tqdm import tqdm

from horizon_dl.config import Config
from horizon_dl.data.source import FrameSource
from horizon_dl.errors import InputError, printable
from horizon_dl.online.frame_log import FrameLog
from horizon_dl.online.tensorboard_log import TensorBoardLog
from horizon_dl.output.files import unwritable
from horizon_dl.output.folder import check_free, claim_folder, is_own, make_folder
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint

CHECKPOINT, FRAMES, LOGS, LOCK = "checkpoint.safetensors", "frames.jsonl", "logs", ".lock"
KIND = "online"
FREE_KEYS = ("checkpoint_frames", "checkpoint_s")
"""Settings under `online` that may change from one start to the next."""


class RunDirectory:
    """Writes what must outlive the process, and goes on where it cannot; one at a time in a folder.

    Attributes:
        found: the snapshot to go on from, or None.
        position: index of the frame to go on with.
        failed: checkpoints that could not be written.
    """

    def __init__(
        self,
        folder: Path,
        source: FrameSource,
        config: Config,
        *,
        restart: bool = False,
        overwrite: bool = False,
    ) -> None:
        self.folder = folder
        self.failed = 0
        self._identity = {"data": source.name, "format": source.format, "config": _identity(config)}
        self._settings = config.online
        try:
            make_folder(folder)
            check_own(folder, overwrite)
            self._lock = _locked(folder)
            claim_folder(folder, KIND, overwrite=overwrite, anew=restart or overwrite)
            if restart or overwrite:
                _clear(folder)
            self.found = self._read()
            place = self.found.values["place"] if self.found else {}
            self.position = int(place.get("position", 0))
            self._log = FrameLog(folder / FRAMES, int(place.get("log_bytes", 0)))
            self._curves = TensorBoardLog(folder / LOGS, self.position)
        except OSError as error:
            raise unwritable(folder, error) from None
        self._wait_from(self.position)

    def due(self, position: int) -> bool:
        """Whether it is time for a checkpoint."""
        enough = position - self._last_position >= self._settings.checkpoint_frames
        return enough or time.monotonic() - self._last_s >= self._settings.checkpoint_s

    def save(self, position: int, snapshot: Snapshot) -> bool:
        """Write a checkpoint; on a full or dead disk say so, count it, and let the learner go on."""
        self._wait_from(position)
        try:
            self._write(position, snapshot)
        except OSError as error:
            self.failed += 1
            self.say(f"no checkpoint ({error.strerror or error}); learning goes on, the last one is intact")
            return False
        return True

    def save_first(self, snapshot: Snapshot) -> None:
        """Write the first checkpoint; InputError where the folder cannot hold it."""
        try:
            self._write(0, snapshot)
        except OSError as error:
            raise unwritable(self.folder, error) from None

    def line(self, line: dict[str, Any], step: int) -> None:
        """Add a frame's line, and its numbers to the curves."""
        self._log.add(line)
        curves = {
            name: value for name, value in line.items() if isinstance(value, float) and name != "time_s"
        }
        self._curves.add(curves, step)

    def say(self, text: str) -> None:
        """A line for the user beside the progress bar."""
        tqdm.write(f"horizon-dl: {printable(text)}", file=sys.stderr)

    def close(self) -> None:
        """Close all files."""
        self._log.close()
        self._curves.close()
        self._lock.release()

    def _read(self) -> Snapshot | None:
        path = self.folder / CHECKPOINT
        if not path.exists():
            return None
        found = read_checkpoint(path)
        for name, own in self._identity.items():
            if found.values["place"][name] != own:
                held = f" ({found.values['place'][name]})" if name == "data" else ""
                problem = f"holds a checkpoint of a run with another {name}{held}"
                raise InputError(self.folder, problem, "give another --out, or start anew with --restart")
        return found

    def _write(self, position: int, snapshot: Snapshot) -> None:
        self._log.save()
        place = {**self._identity, "position": position, "log_bytes": self._log.offset}
        joined = Snapshot(snapshot.tensors, {**snapshot.values, "place": place})
        write_checkpoint(self.folder / CHECKPOINT, joined)

    def _wait_from(self, position: int) -> None:
        self._last_position, self._last_s = position, time.monotonic()


def _locked(folder: Path) -> FileLock:
    """A lock that ends with the process, however it ends."""
    lock = FileLock(folder / LOCK)
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise InputError(
            folder, "is written by another learner", "stop that one, or give another --out"
        ) from None
    return lock


def check_own(folder: Path, overwrite: bool) -> None:
    """Nothing is touched in a folder that is neither empty nor a run's; see `claim_folder`."""
    if not overwrite and not is_own(folder, KIND):
        check_free(folder)


def _clear(folder: Path) -> None:
    """Remove what an earlier run wrote, and nothing else."""
    for path in (folder / CHECKPOINT, folder / FRAMES, *(folder / LOGS).glob("events.out.tfevents.*")):
        path.unlink(missing_ok=True)


def _identity(config: Config) -> dict[str, Any]:
    tree = config.model_dump(mode="json")
    tree["online"] = {name: value for name, value in tree["online"].items() if name not in FREE_KEYS}
    return tree
