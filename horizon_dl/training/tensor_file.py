"""Safetensors files that know their own SHA-256: a damage of a single bit is found when they are read."""

import hashlib
import json
import re
import struct
from collections.abc import Mapping
from pathlib import Path

from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor

from horizon_dl.errors import InputError
from horizon_dl.output.files import system_error

BLANK = "0" * 64
_HASH = re.compile(rb'"sha256":"([0-9a-f]{64})"')
_LENGTH = 8
MOST_HEADER = 64 * 2**20
_BLOCK = 1 << 20


def write_tensors(path: Path, tensors: Mapping[str, Tensor], texts: Mapping[str, str]) -> None:
    """Write tensors and texts; the hash is that of the file with zeros in its place.

    Raises:
        OSError: the disk is full, read-only, or gone.
    """
    whole = {name: tensor.contiguous() for name, tensor in tensors.items()}
    try:
        save_file(whole, path, {**texts, "sha256": BLANK})
    except SafetensorError as error:
        raise system_error(error) from None
    place = _place_of_hash(path)
    if place is None:
        raise OSError(f"{path} does not hold what was written")
    with path.open("r+b") as file:
        file.seek(place)
        file.write(_hash_with_blank(path, place).encode())


def read_tensors(path: Path, hint: str) -> tuple[dict[str, Tensor], dict[str, str]]:
    """Tensors and texts of a file that `write_tensors` wrote; copies, so that the file may be replaced.

    Raises:
        InputError: it is damaged, or another kind of file.
    """
    try:
        check_tensors(path, hint)
        with safe_open(path, "pt") as file:
            texts = file.metadata() or {}
            tensors = {name: file.get_tensor(name).clone() for name in file.keys()}  # noqa: SIM118
    except (OSError, SafetensorError, RuntimeError, ValueError) as error:
        raise InputError(path, f"cannot be read or is damaged ({type(error).__name__})", hint) from None
    return tensors, texts


def check_tensors(path: Path, hint: str) -> None:
    """The file is as it was written.

    Raises:
        InputError: it is not.
        OSError: it cannot be read.
    """
    place = _place_of_hash(path)
    if place is None:
        raise InputError(path, "is no file of horizon-dl or is damaged (it has no checksum)", hint)
    with path.open("rb") as file:
        file.seek(place)
        known = file.read(len(BLANK)).decode()
    if _hash_with_blank(path, place) != known:
        raise InputError(path, "is damaged (its checksum does not fit)", hint)


def _place_of_hash(path: Path) -> int | None:
    """Where the hash begins in the file's header; None where there is none."""
    if not path.is_file():
        return None
    with path.open("rb") as file:
        start = file.read(_LENGTH)
        length = struct.unpack("<Q", start)[0] if len(start) == _LENGTH else 0
        header = file.read(length) if 0 < length <= MOST_HEADER else b""
    # The header's texts are JSON: a hash within one of them would have its quotes escaped.
    found = list(_HASH.finditer(header))
    try:
        json.loads(header)
    except ValueError:
        return None
    return _LENGTH + found[0].start(1) if len(found) == 1 else None


def _hash_with_blank(path: Path, place: int) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        digest.update(file.read(place) + BLANK.encode())
        file.seek(place + len(BLANK))
        while block := file.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()
