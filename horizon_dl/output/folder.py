"""Folders of results: tried before the work, filled as a whole, and never at the cost of what they held."""

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from horizon_dl.errors import InputError
from horizon_dl.output.files import FULL, unwritable
from horizon_dl.output.manifest import Manifest, hashes, held_by, read_manifest, write_manifest
from horizon_dl.output.stage import Stage, clean_left_overs
from horizon_dl.processes import is_helper

HALF_WRITTEN = re.compile(r"\..+\.part|\.tmp\w{6}")
OVERWRITE = "give another --out, or replace it with --overwrite"


@contextmanager
def output_folder(
    out: Path, kind: str = "results", *, overwrite: bool = False, adding: bool = False
) -> Iterator[Path]:
    """A folder to write to, inside `out`; its files take their places in `out` once all went well.

    All of them do, or none. On any error `out` is as it was, and on a kill it is made so at the next start.
    What a helper process writes is thrown away.

    Args:
        out: made where it is missing; a link or a mount point will do.
        kind: the verb whose results these are, for `manifest.json`.
        overwrite: replace what `out` holds: files of the same names, and those that an earlier verb wrote and
            that nobody has altered since. Other files stay.
        adding: `out` is the caller's own folder, and its other results stay.

    Raises:
        InputError: `out` is a file, holds something already, or cannot be written to.
    """
    if is_helper():
        with tempfile.TemporaryDirectory() as scratch:
            yield Path(scratch)
        return
    made: list[Path] = []
    try:
        try:
            made = make_folder(out)
            clean_left_overs(out)
            if not (overwrite or adding):
                check_free(out)
            stage = Stage(out)
        except OSError as error:
            raise unwritable(out, error) from None
        with stage:
            yield stage.new
            files, before = hashes(stage.new), earlier_files(out)
            replacing = overwrite and not adding
            write_manifest(stage.new, Manifest(kind, files if replacing else {**before, **files}))
            stage.commit(before if replacing else {})
        made = []
    except OSError as error:
        if error.errno in FULL:
            raise unwritable(out, error) from None
        raise
    finally:
        for folder in reversed(made):
            with suppress(OSError):  # it is not empty: somebody else uses it, too
                folder.rmdir()


def claim_folder(out: Path, kind: str, *, overwrite: bool = False, anew: bool = False) -> None:
    """Make `out` the caller's own before its results are there: for runs that can be resumed.

    Args:
        out: made where it is missing.
        kind: the verb.
        overwrite: take over whatever `out` holds; see `output_folder`.
        anew: what an earlier run of the same kind wrote goes.

    Raises:
        InputError: `out` is a file, or holds something of another kind.
        OSError: it cannot be written to.
    """
    make_folder(out)
    clean_left_overs(out)
    try:
        own = is_own(out, kind)
    except InputError:  # a damaged manifest: whose the folder is cannot be told
        if not overwrite:
            raise
        own = False
    if not (own or overwrite):
        check_free(out)
    if own:
        _remove_half_written(out)
    if not own or anew:
        with Stage(out) as stage:
            write_manifest(stage.new, Manifest(kind))
            stage.commit(earlier_files(out))


def _remove_half_written(out: Path) -> None:
    """Checkpoints that a killed run wrote half, and safetensors' own files beside them."""
    for path in out.glob(".*"):
        if path.is_file() and HALF_WRITTEN.fullmatch(path.name):
            path.unlink(missing_ok=True)


def check_free(out: Path) -> None:
    """The folder, where there is one, is empty.

    Raises:
        InputError: it holds results, or files of something else.
    """
    held = held_by(out) if out.is_dir() else []
    if not held:
        return
    try:
        found = read_manifest(out)
    except InputError:
        found = None
    problem = (
        f"holds files already, as {held[0]}" if found is None else f"holds results of `{found.kind}` already"
    )
    raise InputError(out, problem, OVERWRITE)


def is_own(out: Path, kind: str) -> bool:
    """Whether a folder holds what a verb wrote.

    Raises:
        InputError: its manifest is damaged.
    """
    found = read_manifest(out)
    return found is not None and found.kind == kind


def earlier_files(out: Path) -> dict[str, str]:
    """SHA-256 by name of the results that a folder holds; nothing where that cannot be told."""
    try:
        found = read_manifest(out)
    except InputError:
        found = None
    return {} if found is None else found.files


def make_folder(out: Path) -> list[Path]:
    """Make a folder with its parents; returns those that were not there, the outermost first.

    Raises:
        InputError: there is a file.
        OSError: it cannot be made.
    """
    if out.exists() and not out.is_dir():
        raise InputError(out, "is a file", "give a folder with --out")
    missing = [folder for folder in (out, *out.parents) if not folder.exists()]
    out.mkdir(parents=True, exist_ok=True)
    return missing[::-1]
