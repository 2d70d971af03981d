"""Checkpoints: one safetensors file with tensors and JSON, which is there as a whole or not at all."""

import json
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor

from horizon_dl.errors import InputError

FORMAT = 2
SEPARATOR = "/"
_VALUES = "values"


@dataclass(frozen=True)
class Snapshot:
    """All that one part of the program needs to go on as if it had never stopped.

    Attributes:
        tensors: by name.
        values: what JSON can hold; numbers come back to the bit.
    """

    tensors: dict[str, Tensor] = field(default_factory=dict)
    values: dict[str, Any] = field(default_factory=dict)

    @staticmethod
    def join(parts: Mapping[str, "Snapshot"]) -> "Snapshot":
        """One snapshot of several; `part` takes it apart again."""
        tensors = {
            f"{name}{SEPARATOR}{key}": tensor
            for name, part in parts.items()
            for key, tensor in part.tensors.items()
        }
        return Snapshot(tensors, {name: part.values for name, part in parts.items()})

    def part(self, name: str) -> "Snapshot":
        """The snapshot that was joined under a name.

        Raises:
            KeyError: there is none.
        """
        prefix = name + SEPARATOR
        tensors = {
            key.removeprefix(prefix): tensor for key, tensor in self.tensors.items() if key.startswith(prefix)
        }
        return Snapshot(tensors, self.values[name])


def write_checkpoint(path: Path, snapshot: Snapshot) -> None:
    """Write beside, force it to the disk, rename: whenever the power goes, `path` is the old one or the new.

    Raises:
        OSError: the disk is full, read-only, or gone; what was at `path` still is.
    """
    values = {"format": FORMAT, **snapshot.values}
    tensors = {name: tensor.contiguous() for name, tensor in snapshot.tensors.items()}
    with replacing(path) as beside:
        try:
            save_file(tensors, beside, {_VALUES: json.dumps(values, allow_nan=False)})
        except SafetensorError as error:
            raise _system_error(error) from None


def read_checkpoint(path: Path) -> Snapshot:
    """The snapshot in a file.

    Raises:
        InputError: the file is damaged, or of another version.
    """
    try:
        with safe_open(path, "pt") as file:
            values = json.loads((file.metadata() or {})[_VALUES])
            # Copied: what is given may be a view of the file, which the next checkpoint replaces.
            tensors = {name: file.get_tensor(name).clone() for name in file.keys()}  # noqa: SIM118
    except (OSError, SafetensorError, KeyError, ValueError) as error:
        raise InputError(
            path, f"is no checkpoint or damaged ({type(error).__name__})", "start anew with --restart"
        ) from None
    if values.pop("format", None) != FORMAT:
        raise InputError(path, "is of another version of horizon-dl", "start anew with --restart")
    return Snapshot(tensors, values)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, which takes its place when all went well and is on the disk.

    What an earlier process that was killed left beside is removed.
    """
    beside = path.with_name(f".{path.name}.part")
    try:
        yield beside
        _to_disk(beside)
        beside.replace(path)
        _to_disk(path.parent)
    finally:
        beside.unlink(missing_ok=True)


def _system_error(error: SafetensorError) -> OSError:
    """The system's error, which safetensors wraps in words."""
    found = re.search(r"os error (\d+)", str(error))
    return OSError(int(found[1]), os.strerror(int(found[1]))) if found else OSError(str(error))


def _to_disk(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
