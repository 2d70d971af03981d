"""Opens a recording of any known format: the readers, in the order in which they are asked."""

from pathlib import Path
from typing import Protocol

from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.readers import (
    euroc,
    film,
    image_files,
    images_csv,
    kitti,
    kitti_odometry,
    paparazzi,
    tartanair,
    tum,
)
from horizon_dl.data.readers.parsing import images_in, relative_name
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError


class Reader(Protocol):
    """What a reader's module offers."""

    NAME: str
    NEEDS: str

    def recognises(self, path: Path) -> bool:
        """Whether the file or folder looks like this format."""

    def read(self, path: Path, given: Given) -> Recording:
        """Opens the recording."""


MODULES: tuple[Reader, ...] = (
    images_csv,
    kitti,
    kitti_odometry,
    euroc,
    tartanair,
    tum,
    paparazzi,
    film,
    image_files,
)
DEEPEST, MOST_FOLDERS = 3, 300
"""How far below a folder its recordings are looked for."""

READERS = {reader.NAME: reader for reader in MODULES}
FORMATS: tuple[str, ...] = tuple(READERS)


def open_recording(path: Path, format: str | None = None, given: Given = NOTHING_GIVEN) -> Recording:
    """The recording in a file or folder, its format recognised or named.

    Raises:
        InputError: no such path, a format that is not known or not recognised, or a fault in the data.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(path, "does not exist", "give the file or folder of a recording")
    if format is None:
        format, path = recognise(path)
    if format not in READERS:
        raise InputError(f"--format {format}", "is not known", "choose one of " + ", ".join(FORMATS))
    return READERS[format].read(path, given)


def recognise(path: Path) -> tuple[str, Path]:
    """Name of the first format that the path, else the one recording in the folders below it, looks like.

    Raises:
        InputError: none, or several recordings below; the error lists them, or what each format needs.
    """
    name = _recognised(path)
    if name and name != image_files.NAME:
        return name, path
    if not name or not images_in(path):
        below = _below(path) if path.is_dir() else []
        if len(below) == 1:
            return below[0]
        if below:
            names = ", ".join(relative_name(place, path) for _, place in below[:5])
            more = ", ..." if len(below) > 5 else ""
            problem = f"holds {len(below)} recordings: {names}{more}"
            raise InputError(path, problem, "give the folder of one of them")
    if name:
        return name, path
    needs = "; ".join(f"{name}: {reader.NEEDS}" for name, reader in READERS.items())
    empty = path.is_dir() and not any(path.iterdir())
    problem = "is empty" if empty else "is not a recording of a known format"
    raise InputError(path, problem, f"needed is one of: {needs}")


def _recognised(path: Path) -> str | None:
    return next((name for name, reader in READERS.items() if reader.recognises(path)), None)


def _may_hold(folder: Path) -> bool:
    return folder.is_dir() and folder.name[0] not in "._"


def _below(path: Path) -> list[tuple[str, Path]]:
    """The recordings in the highest level of folders below a path that has any; no plain pictures."""
    level = [path]
    for _ in range(DEEPEST):
        level = [
            p for place in level for p in sorted(place.iterdir()) if p.is_dir() and p.name[0] not in "._"
        ]
        named = ((_recognised(place), place) for place in level[:MOST_FOLDERS])
        found = [(name, place) for name, place in named if name and name != image_files.NAME]
        if found:
            return found
    return []
