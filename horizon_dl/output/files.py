"""Single files that are there as a whole or not at all."""

import errno
import json
import math
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from horizon_dl.errors import InputError

FULL = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG, errno.EIO})
"""What the system says of a disk that takes no more."""


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file as a whole or not at all; its folder is made where it is missing.

    What an earlier process that was killed left beside is replaced.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = part_of(path)
    try:
        beside.write_bytes(content)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def write_text(path: Path, content: str) -> None:
    """As `write_bytes`, for UTF-8 text; a file name that is none (it may be any bytes) is written escaped."""
    write_bytes(path, content.encode(errors="backslashreplace"))


def write_json(path: Path, value: Any) -> None:
    """As `write_bytes`, for JSON; NaN is refused, since it is no JSON."""
    write_text(path, json.dumps(value, indent=1, allow_nan=False) + "\n")


def without_nan(value: Any) -> Any:
    """A tree for JSON with None in place of NaN and infinities: what is not known has no number."""
    if isinstance(value, dict):
        return {key: without_nan(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def check_file(path: Path, overwrite: bool, option: str = "--out") -> None:
    """A single file of results can be written, and nothing is lost by it.

    Raises:
        InputError: it is there already and may not be replaced, or its folder takes no files.
    """
    if path.is_dir():
        raise InputError(path, "is a folder", f"give a file with {option}")
    if path.exists() and not overwrite:
        raise InputError(path, "exists already", f"give another {option}, or replace it with --overwrite")
    try:
        with tempfile.TemporaryFile(dir=path.absolute().parent):
            pass
    except OSError as error:
        raise InputError(path, f"cannot be written ({error.strerror})", f"give another {option}") from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, which takes its place when all went well and is on the disk.

    Whenever the power goes, `path` is the old file or the new one. What an earlier process that was killed
    left beside is removed.
    """
    beside = part_of(path)
    try:
        yield beside
        to_disk(beside)
        beside.replace(path)
        to_disk(path.parent)
    finally:
        beside.unlink(missing_ok=True)


def move(source: Path, target: Path) -> None:
    """Rename; where a link or mount point leads to another file system, copy whole and then remove."""
    try:
        source.replace(target)
    except OSError as error:
        if error.errno != errno.EXDEV:
            raise
        beside = part_of(target)
        try:
            if source.is_dir():
                shutil.copytree(source, beside, dirs_exist_ok=True)
                beside.rename(target)
                shutil.rmtree(source)
            else:
                shutil.copy2(source, beside)
                beside.replace(target)
                source.unlink()
        finally:
            remove(beside)


def remove(path: Path) -> None:
    """Remove a file or a folder with all in it; nothing happens where there is none."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def part_of(path: Path) -> Path:
    """Where a file is written before it takes its place."""
    name = path.name
    if len(os.fsencode(name)) > 240:  # with dot and ending it would be longer than a name may be
        name = str(abs(hash(name)))
    return path.with_name(f".{name}.part")


def to_disk(path: Path) -> None:
    """Force a file's content, or a folder's entries, to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def system_error(error: Exception) -> OSError:
    """The system's error, which some libraries wrap in words (`... os error 28`)."""
    found = re.search(r"os error (\d+)", str(error))
    return OSError(int(found[1]), os.strerror(int(found[1]))) if found else OSError(str(error))


def unwritable(out: Path, error: OSError) -> InputError:
    """The error in one line for a place that takes no results."""
    where = error.filename if isinstance(error.filename, str) and error.errno in FULL else out
    hint = "make room there, or give another --out" if error.errno in FULL else "give another --out"
    return InputError(where, f"cannot be written ({error.strerror or error})", hint)
