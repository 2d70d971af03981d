"""Names of results after the frames they belong to: short where that is enough, and never the same twice."""

import hashlib
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path, PurePosixPath

LONGEST = 150
"""Bytes of a part of a name; file systems take 255, with ending and a temporary file's dots."""


class ResultNames:
    """Gives every frame a name of its own, without ending, below a folder of results.

    Args:
        names: of all frames where they are known; folders that all of them have in common are left out.

    Example:
        >>> one = ResultNames(["images/a/1.png", "images/b/1.png"])
        >>> one("images/a/1.png"), one("images/b/1.png")
        ('a/1', 'b/1')
    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        folders = [inside(name).parent.parts for name in names]
        self._common = _common_parts(folders) if folders else None
        self._short = Counter(self._without_ending(name) for name in set(names))
        self._given: set[str] = set()

    def __call__(self, name: str) -> str:
        """The next frame's; one of a name that was given before gets a number."""
        found = next(one for one in self._candidates(name) if one not in self._given)
        self._given.add(found)
        return found

    def _candidates(self, name: str) -> Iterator[str]:
        short, whole = self._without_ending(name), inside(name).as_posix()
        if self._short[short] < 2:
            yield short
        yield whole
        yield from (f"{whole}-{number}" for number in count(2))

    def _without_ending(self, name: str) -> str:
        path = inside(name)
        folders = path.parent.parts[self._common :] if self._common is not None else ()
        return PurePosixPath(*folders, path.stem or path.name).as_posix()


def _common_parts(folders: Sequence[tuple[str, ...]]) -> int:
    """How many folders all begin with."""
    first, last = min(folders), max(folders)
    pairs = zip(first, last, strict=False)
    return next(
        (index for index, (one, other) in enumerate(pairs) if one != other), min(len(first), len(last))
    )


def inside(name: str) -> PurePosixPath:
    """A frame's name as a path that leaves no folder: without root and parents, in parts of bearable length.

    Example:
        >>> inside("/etc/../../passwd")
        PurePosixPath('etc/passwd')
    """
    parts = [part for part in Path(name).parts if part not in ("/", "..", ".") and part.strip("\\/")]
    return PurePosixPath(*[_bearable(part) for part in parts] or ["frame"])


def _bearable(part: str) -> str:
    content = os.fsencode(part.replace("\0", ""))
    if len(content) <= LONGEST:
        return os.fsdecode(content)
    digest = hashlib.sha256(content).hexdigest()[:8]
    return f"{content[: LONGEST // 2].decode(errors='ignore')}-{digest}{Path(part).suffix[:8]}"
