"""The place inside a folder of results where they wait until all are there, and the way into their places."""

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType

from horizon_dl.errors import InputError
from horizon_dl.output.files import move, remove
from horizon_dl.output.manifest import file_hash

try:
    import fcntl
except ImportError:  # not on Windows: left-overs of killed runs stay there
    fcntl = None  # type: ignore[assignment]

PREFIX = ".horizon-dl-"
LOCK, NEW, OLD, JOURNAL = "lock", "new", "old", "journal"


class Stage:
    """A hidden folder inside `out`, in its own file system; removed at the end, whatever happens.

    While its process lives it holds a lock, so that others know what is left over.

    Attributes:
        new: what is to take its place in `out`.
    """

    def __init__(self, out: Path) -> None:
        """Make it.

        Raises:
            OSError: nothing can be written in `out`.
        """
        self._out = out.absolute()
        self._place = Path(tempfile.mkdtemp(prefix=PREFIX, dir=self._out))
        self._lock = _lock(self._place)
        self.new = self._place / NEW
        self.new.mkdir()

    def __enter__(self) -> "Stage":
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        roll_back(self._place, self._out)
        remove(self._place)
        if self._lock is not None:
            os.close(self._lock)

    def commit(self, replaced: Mapping[str, str]) -> None:
        """Move all into their places; on an error, all goes back.

        Args:
            replaced: SHA-256 by name of earlier results, which go unless they were altered.
        """
        old, units = self._place / OLD, list(_units(self.new, self._out))
        gone = [name for name in replaced if self._is_stale(name, replaced[name])]
        plan = {"place": [unit.as_posix() for unit in units], "remove": gone}
        (self._place / JOURNAL).write_text(json.dumps(plan))
        for name in (*plan["place"], *gone):
            if os.path.lexists(self._out / name):
                (old / name).parent.mkdir(parents=True, exist_ok=True)
                move(self._out / name, old / name)
            if name not in gone:
                move(self.new / name, self._out / name)
        (self._place / JOURNAL).unlink()  # from here on the new results are the folder's
        for name in gone:
            _remove_empty(self._out, (self._out / name).parent)

    def _is_stale(self, name: str, known: str) -> bool:
        """Whether an earlier result is neither written again nor altered by somebody."""
        path = self._out / name
        known_file = _inside(name) and not (self.new / name).exists() and path.is_file()
        return known_file and file_hash(path) == known


def clean_left_overs(out: Path) -> None:
    """Remove what killed processes left in a folder; a move that was cut short is undone first."""
    for place in out.glob(f"{PREFIX}*"):
        lock = _lock(place) if place.is_dir() else None
        if lock is not None:
            roll_back(place, out)
            remove(place)
            os.close(lock)


def roll_back(place: Path, out: Path) -> None:
    """Undo the moves of a stage's journal; nothing happens where there is none."""
    try:
        plan = json.loads((place / JOURNAL).read_text())
    except (OSError, ValueError):
        return  # a journal that was not written whole: nothing was moved yet
    if any(not _inside(name) for name in (*plan["place"], *plan["remove"])):
        return  # not written by `Stage.commit`
    for name in plan["place"]:
        if not os.path.lexists(place / NEW / name) and os.path.lexists(out / name):
            move(out / name, place / NEW / name)
    for name in (*plan["place"], *plan["remove"]):
        if os.path.lexists(place / OLD / name):
            move(place / OLD / name, out / name)
    (place / JOURNAL).unlink()


def _units(new: Path, out: Path, below: Path = Path()) -> Iterator[Path]:
    """What is moved as one: files, and folders that `out` does not have yet."""
    for path in sorted((new / below).iterdir()):
        name = below / path.name
        if path.is_dir() and (out / name).is_dir():
            yield from _units(new, out, name)
        elif os.path.lexists(out / name) and path.is_dir() != (out / name).is_dir():
            kind = "folder" if path.is_dir() else "file"
            raise InputError(out / name, f"stands where a {kind} has to be", "move it, or give another --out")
        else:
            yield name


def _lock(place: Path) -> int | None:
    """A lock that ends with the process, however it ends; None where another process holds it."""
    if fcntl is None:
        return None
    handle = os.open(place / LOCK, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(handle)
        return None
    return handle


def _remove_empty(out: Path, folder: Path) -> None:
    while folder != out and folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent


def _inside(name: str) -> bool:
    return not Path(name).is_absolute() and ".." not in Path(name).parts
