"""Opens a folder of any known format."""

from pathlib import Path
from typing import Protocol

from horizon_dl.data.frame import Recording
from horizon_dl.data.readers import euroc, images_csv, kitti, paparazzi, tum
from horizon_dl.errors import InputError


class Reader(Protocol):
    """What a reader's module offers."""

    NAME: str
    NEEDS: str

    def recognises(self, folder: Path) -> bool:
        """Whether the folder looks like this format."""

    def read(self, folder: Path) -> Recording:
        """Opens the set."""


MODULES: tuple[Reader, ...] = (images_csv, kitti, paparazzi, tum, euroc)
READERS = {reader.NAME: reader for reader in MODULES}
FORMATS: tuple[str, ...] = tuple(READERS)


def open_recording(folder: Path, format: str | None = None) -> Recording:
    """The recording in a folder, its format recognised or named.

    Raises:
        InputError: no such folder, a format that is not known or not recognised, or a fault in the set.
    """
    folder = Path(folder)
    if not folder.is_dir():
        problem = "is a file" if folder.exists() else "does not exist"
        raise InputError(folder, problem, "give the folder of a data set")
    if format is None:
        format = recognise(folder)
    if format not in READERS:
        raise InputError(f"--format {format}", "is not known", "choose one of " + ", ".join(FORMATS))
    return READERS[format].read(folder)


def recognise(folder: Path) -> str:
    """Name of the first format that the folder looks like.

    Raises:
        InputError: none; the error lists what each format needs.
    """
    for name, reader in READERS.items():
        if reader.recognises(folder):
            return name
    needs = "; ".join(f"{name}: {reader.NEEDS}" for name, reader in READERS.items())
    problem = "is empty" if not any(folder.iterdir()) else "is not a data set of a known format"
    raise InputError(folder, problem, f"needed is one of: {needs}")
