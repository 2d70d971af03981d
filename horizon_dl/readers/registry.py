"""Opens a recording of any known format: the readers, in the order in which they are asked."""

from pathlib import Path
from typing import Protocol

from horizon_dl.data.from_images import FROM_IMAGES, camera_alone, with_attitude_from_images
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.regular_file import check_there
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import images_in, relative_name
from horizon_dl.data.tables.text import PACKED, UNPACK
from horizon_dl.errors import InputError
from horizon_dl.readers import (
    dji_photos,
    euroc,
    film,
    gopro,
    image_files,
    images_csv,
    kitti,
    kitti_odometry,
    mars,
    paparazzi,
    ros_bag,
    sensor_logger,
    tartanair,
    tum,
)
from horizon_dl.readers.plugins import Plugins, plugins


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
    ros_bag,
    mars,
    sensor_logger,
    gopro,
    film,
    dji_photos,
    image_files,
)
DEEPEST, MOST_FOLDERS = 3, 300
"""How far below a folder its recordings are looked for."""

OWN_ATTITUDE = {"kitti", "tum", "euroc", "paparazzi", "tartanair", "dji_photos"}
OWN_CAMERA = {"kitti", "kitti_odometry"}

READERS = {reader.NAME: reader for reader in MODULES}
FORMATS: tuple[str, ...] = tuple(READERS)


def open_recording(path: Path, format: str | None = None, given: Given = NOTHING_GIVEN) -> Recording:
    """The recording in a file or folder, its format recognised or named.

    Raises:
        InputError: no such path, a format that is not known or not recognised, or a fault in the data.
    """
    path = Path(path)
    check_there(path)
    found = plugins()
    readers = _all(found)
    if format is None:
        format, path = _found(path, readers, found.broken)
    if format not in readers:
        problem = found.broken.get(format, "is not known")
        raise InputError(f"--format {format}", problem, "choose one of " + ", ".join(readers))
    if given.attitude == FROM_IMAGES:
        return with_attitude_from_images(readers[format].read(path, camera_alone(given)))
    _check_given(format, given)
    recording = readers[format].read(path, given)
    return recording if given.convention is None else recording.read_as(given.convention)


def _check_given(format: str, given: Given) -> None:
    """InputError where something is given that the data set has itself: it would be left out in silence."""
    if given.attitude is not None and format in OWN_ATTITUDE:
        problem = f"has no meaning for {format}, which has its own"
        raise InputError(f"--attitude {given.attitude}", problem, "leave it out")
    if given.camera is not None and format in OWN_CAMERA:
        problem = f"has no meaning for {format}, which has its own"
        raise InputError(f"--camera {given.camera}", problem, "leave it out")


def _all(found: Plugins) -> dict[str, Reader]:
    """The package's own readers and other people's, in the order in which they are asked.

    Other people's go before the two that take whatever is a film or holds pictures; no name is taken over.
    """
    general = (film, image_files)
    special = {reader.NAME: reader for reader in MODULES if reader not in general}
    last = {reader.NAME: reader for reader in general}
    others = {name: reader for name, reader in found.readers.items() if name not in READERS}
    return {**special, **others, **last}


def _found(path: Path, readers: dict[str, Reader], broken: dict[str, str]) -> tuple[str, Path]:
    name = _recognised(path, readers)
    if path.is_dir() and (name is None or (name == image_files.NAME and not images_in(path))):
        below = _below(path, readers)
        if len(below) == 1:
            return below[0]
        if below:
            names = ", ".join(relative_name(place, path) for _, place in below[:5])
            problem = f"holds {len(below)} recordings: {names}{', ...' * (len(below) > 5)}"
            raise InputError(path, problem, "give the folder of one of them")
    if name is not None:
        return name, path
    films = film.films_in(path) if path.is_dir() else []
    if len(films) > 1:
        names = ", ".join(one.name for one in films[:5])
        problem = f"holds {len(films)} films: {names}{', ...' * (len(films) > 5)}"
        raise InputError(path, problem, "give one of them")
    if path.is_file() and path.suffix.lower() in film.LOG_SUFFIXES:
        way_out = (
            f"give its film or the folder of its pictures, with --attitude {path.name} and --camera FILE"
        )
        raise InputError(path, "is no recording; by its name it is a log", way_out)
    unusable = "".join(f"; {name} is installed, but {why}" for name, why in broken.items())
    if path.is_file() and path.suffix.lower() in PACKED:
        raise InputError(path, "is no recording, but packed", f"{UNPACK}{unusable}")
    needs = "; ".join(f"{name}: {reader.NEEDS}" for name, reader in readers.items())
    empty = path.is_dir() and not any(path.iterdir())
    problem = "is empty" if empty else "is not a recording of a known format"
    raise InputError(path, problem, f"needed is one of: {needs}{unusable}")


def _recognised(path: Path, readers: dict[str, Reader]) -> str | None:
    return next((name for name, reader in readers.items() if reader.recognises(path)), None)


def _below(path: Path, readers: dict[str, Reader]) -> list[tuple[str, Path]]:
    """The recordings in the highest level of folders below a path that has any; no plain pictures."""
    level = [path]
    for _ in range(DEEPEST):
        level = [child for place in level for child in _folders_in(place)][:MOST_FOLDERS]
        named = ((_recognised(place, readers), place) for place in level)
        found = [(name, place) for name, place in named if name and name != image_files.NAME]
        if found:
            return found
    return []


def _folders_in(folder: Path) -> list[Path]:
    try:
        return sorted(one for one in folder.iterdir() if one.is_dir() and one.name[0] not in "._")
    except OSError:
        return []
