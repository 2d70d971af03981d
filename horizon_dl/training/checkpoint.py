"""Checkpoints: one safetensors file with tensors and JSON, which is there as a whole or not at all."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from torch import Tensor

from horizon_dl.errors import InputError
from horizon_dl.output.files import replacing
from horizon_dl.training.tensor_file import read_tensors, write_tensors

FORMAT = 6
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
    with replacing(path) as beside:
        write_tensors(beside, snapshot.tensors, {_VALUES: json.dumps(values, allow_nan=False)})


def read_checkpoint(path: Path, hint: str = "start anew with --restart") -> Snapshot:
    """The snapshot in a file.

    Raises:
        InputError: the file is damaged, or of another version.
    """
    tensors, texts = read_tensors(path, hint)
    try:
        values = json.loads(texts[_VALUES])
        version = values.pop("format", None)
    except (KeyError, ValueError, AttributeError, RecursionError):
        raise InputError(path, "is no checkpoint", hint) from None
    if version != FORMAT:
        raise InputError(path, "is of another version of horizon-dl", hint)
    return Snapshot(tensors, values)
