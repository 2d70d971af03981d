"""Opens a recording of any known format: the readers, in the order in which they are asked."""

from pathlib import Path
from typing import Protocol

from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.readers import euroc, film, image_files, images_csv, kitti, paparazzi, ros_bag, tum
from horizon_dl.data.readers.plugins import Plugins, plugins
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


MODULES: tuple[Reader, ...] = (images_csv, kitti, paparazzi, tum, euroc, ros_bag, film, image_files)
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
    found = plugins()
    readers = _all(found)
    if format is None:
        format = _recognised(path, readers, found.broken)
    if format not in readers:
        problem = found.broken.get(format, "is not known")
        raise InputError(f"--format {format}", problem, "choose one of " + ", ".join(readers))
    return readers[format].read(path, given)


def recognise(path: Path) -> str:
    """Name of the first format that the path looks like.

    Raises:
        InputError: none; the error lists what each format needs.
    """
    found = plugins()
    return _recognised(path, _all(found), found.broken)


def _all(found: Plugins) -> dict[str, Reader]:
    """The package's own readers and other people's, in the order in which they are asked.

    Other people's go before the two that take whatever is a film or holds pictures; no name is taken over.
    """
    general = (film, image_files)
    special = {reader.NAME: reader for reader in MODULES if reader not in general}
    last = {reader.NAME: reader for reader in general}
    others = {name: reader for name, reader in found.readers.items() if name not in READERS}
    return {**special, **others, **last}


def _recognised(path: Path, readers: dict[str, Reader], broken: dict[str, str]) -> str:
    for name, reader in readers.items():
        if reader.recognises(path):
            return name
    needs = "; ".join(f"{name}: {reader.NEEDS}" for name, reader in readers.items())
    unusable = "".join(f"; {name} is installed, but {why}" for name, why in broken.items())
    empty = path.is_dir() and not any(path.iterdir())
    problem = "is empty" if empty else "is not a recording of a known format"
    raise InputError(path, problem, f"needed is one of: {needs}{unusable}")
