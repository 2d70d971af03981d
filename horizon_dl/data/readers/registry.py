"""Opens a recording of any known format: the readers, in the order in which they are asked."""

from pathlib import Path
from typing import Protocol

from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.readers import euroc, film, image_files, images_csv, kitti, paparazzi, tum
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


MODULES: tuple[Reader, ...] = (images_csv, kitti, paparazzi, tum, euroc, film, image_files)
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
        format = recognise(path)
    if format not in READERS:
        raise InputError(f"--format {format}", "is not known", "choose one of " + ", ".join(FORMATS))
    return READERS[format].read(path, given)


def recognise(path: Path) -> str:
    """Name of the first format that the path looks like.

    Raises:
        InputError: none; the error lists what each format needs.
    """
    for name, reader in READERS.items():
        if reader.recognises(path):
            return name
    needs = "; ".join(f"{name}: {reader.NEEDS}" for name, reader in READERS.items())
    empty = path.is_dir() and not any(path.iterdir())
    problem = "is empty" if empty else "is not a recording of a known format"
    raise InputError(path, problem, f"needed is one of: {needs}")
