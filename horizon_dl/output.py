"""Writing results so that nothing half-written is ever left."""

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from horizon_dl.errors import InputError
from horizon_dl.processes import is_helper


@contextmanager
def output_folder(out: Path) -> Iterator[Path]:
    """A folder beside `out` to write to; its files move into `out` once all went well.

    Files of earlier results that are not written again stay. On any error `out` is as it was. What a helper
    process writes is thrown away.

    Raises:
        InputError: `out` is a file, or its place cannot be written to.
    """
    if is_helper():
        with tempfile.TemporaryDirectory() as scratch:
            yield Path(scratch)
        return
    out = out.absolute()
    if out.exists() and not out.is_dir():
        raise InputError(out, "is a file", "give a folder with --out")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=f".{out.name}.", dir=out.parent))
    except OSError as error:
        raise InputError(out, f"cannot be written ({error.strerror})", "give another --out") from None
    try:
        beside.chmod(0o755)
        yield beside
        _move_into(beside, out)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file as a whole or not at all; its folder is made where it is missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.write_bytes(content)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def write_text(path: Path, content: str) -> None:
    """As `write_bytes`, for UTF-8 text."""
    write_bytes(path, content.encode())


def write_json(path: Path, value: Any) -> None:
    """As `write_bytes`, for JSON; NaN is refused, since it is no JSON."""
    write_text(path, json.dumps(value, indent=1, allow_nan=False) + "\n")


def _move_into(source: Path, out: Path) -> None:
    if not out.exists():
        os.rename(source, out)  # noqa: PTH104  (Path.rename would return a new path object for nothing)
        return
    for path in sorted(source.rglob("*")):
        target = out / path.relative_to(source)
        if path.is_dir():
            target.mkdir(exist_ok=True)
        else:
            path.replace(target)
