"""Files that belong to images and lie in a folder beside them: labels, depth, ranges."""

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from horizon_dl.data.tables.parsing import LONGEST_NAME


def files_beside(folder: Path, kind: str, names: Sequence[str]) -> list[Path | None]:
    """Per image the file `folder/kind/NAME.png`, where there is one.

    NAME is the image's path without its suffix, or the end of that path, the longest first; an end that
    several images share belongs to none of them.

    Args:
        folder: of the recording.
        kind: name of the folder, as `labels`.
        names: paths of the images relative to the recording, with forward slashes.

    Example:
        >>> files_beside(Path("flight"), "labels", ["images/a.png"])   # flight/labels/a.png is there
        ... # doctest: +SKIP
        [PosixPath('flight/labels/a.png')]
    """
    if not (folder / kind).is_dir():
        return [None] * len(names)
    paths = [[*PurePosixPath(name).with_suffix("").parts] for name in names]
    different = ([*PurePosixPath(name).with_suffix("").parts] for name in set(names))
    ends = Counter(tuple(path[start:]) for path in different for start in range(len(path)))
    found: list[Path | None] = []
    for path in paths:
        places = ((folder / kind).joinpath(*path[start:]) for start in _own(path, ends))
        files = (place.with_name(f"{place.name}.png") for place in places if _possible(place))
        found.append(next((file for file in files if file.is_file()), None))
    return found


def _possible(place: Path) -> bool:
    return bool(place.name) and len(os.fsencode(place.name)) + len(".png") <= LONGEST_NAME


def _own(path: list[str], ends: Counter[tuple[str, ...]]) -> list[int]:
    """Where the ends of a path start that no other image has."""
    safe = [start for start in range(len(path)) if ends[tuple(path[start:])] == 1]
    return [start for start in safe if ".." not in path[start:] and "/" not in path[start:]]
