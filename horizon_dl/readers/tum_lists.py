"""The lists of a TUM RGB-D folder: images, depth images, the trajectory, under the names that they have."""

import math
import re
from pathlib import Path, PurePosixPath

from horizon_dl.data.tables.parsing import IMAGE_SUFFIXES, inside_folder, read_lines
from horizon_dl.errors import InputError

IMAGE_LISTS = ("rgb.txt", "rgb.csv", "image.txt", "images.txt", "color.txt", "gray.txt")
ASSOCIATIONS = (
    *("associations.txt", "association.txt", "associate.txt", "associated.txt", "assoc.txt"),
    *("rgb_associations.txt", "depth_associations.txt", "matched.txt"),
)
TRAJECTORIES = (
    *("groundtruth.txt", "groundtruth.csv", "ground_truth.txt", "gt.txt", "trajectory.txt", "traj.txt"),
    *("poses.txt", "pose.txt", "gt_poses.txt"),
)
PICTURES = ("rgb", "image", "images", "color", "gray")
HEADERS = ("timestamp", "time", "stamp", "t", "id", "index")
Listed = list[tuple[float, str]]


def has_lists(folder: Path) -> bool:
    """Whether the folder looks like this format: `rgb.txt` alone tells it, other names with a trajectory."""
    found = _list_of(folder, IMAGE_LISTS)
    return found is not None and (found.name == IMAGE_LISTS[0] or find_trajectory(folder) is not None)


def find_images(folder: Path) -> Listed:
    """Times and names of the images, from `rgb.txt` or a list of associations; empty where there is neither.

    Raises:
        InputError: a line of the list is not `time name`.
    """
    return _listed(_list_of(folder, IMAGE_LISTS), depth=False)


def found_images(folder: Path, listed: Listed) -> Listed:
    """The list with paths in the folder, where it has bare names of images in `rgb`, or another machine's."""
    for place in ("", *PICTURES):
        ends = [(time_s, f"{place}/{PurePosixPath(name).name}".lstrip("/")) for time_s, name in listed]
        for names in (listed, ends) if not place else (ends,):
            if _is_there(folder, names[0][1]):
                return names
    return listed


def _is_there(folder: Path, name: str) -> bool:
    try:
        return inside_folder(folder, folder, name).is_file()
    except InputError:
        return False


def find_depths(folder: Path) -> Listed:
    """As `find_images`, of the depth images; empty where there are none."""
    return _listed(_list_of(folder, ("depth.txt",)), depth=True)


def find_trajectory(folder: Path) -> Path | None:
    """The file of the trajectory."""
    named = [folder / name for name in TRAJECTORIES if (folder / name).is_file()]
    return next(iter([*named, *sorted(folder.glob("*.freiburg"))]), None)


def _list_of(folder: Path, names: tuple[str, ...]) -> Path | None:
    places = (folder / name for name in (*names, *ASSOCIATIONS))
    return next((place for place in places if place.is_file()), None)


def _listed(path: Path | None, *, depth: bool) -> Listed:
    if path is None:
        return []
    return read_associations(path, depth=depth) if path.name in ASSOCIATIONS else read_list(path)


def read_list(path: Path) -> Listed:
    """Times (s) and file names, separated by blanks, tabs or commas.

    Raises:
        InputError: missing, or a line is not `time name`.
    """
    pairs: Listed = []
    for line in _lines(path):
        stamp, *rest = re.split(r"[\s,;]+", line, maxsplit=1)
        name = rest[0].strip(" ,;") if rest else ""
        # A list of associations under the name of a plain one: its first image counts.
        name = re.split(r"[\s,;]+", name)[0] if len(_images_of(name)) > 1 else name
        try:
            time_s = float(stamp)
        except ValueError:
            time_s = math.nan
        if not pairs and stamp.lower() in HEADERS:
            continue  # a header without its sign
        if not name or not math.isfinite(time_s):
            raise InputError(path, f"holds the line {line[:40]!r}", "lines are 'time filename'")
        pairs.append((time_s, name))
    return pairs


def read_associations(path: Path, *, depth: bool) -> Listed:
    """Of lines `time rgb/A.png time depth/B.png`, in either order, the pictures or the depth images.

    Raises:
        InputError: a line is no such line.
    """
    pairs = []
    for line in _lines(path):
        cells = [cell for cell in re.split(r"[\s,;]+", line) if cell]
        chosen = [cell for cell in _images_of(line) if ("depth" in cell.lower()) == depth]
        try:
            time_s = float(cells[cells.index(chosen[0]) - 1])
        except (ValueError, IndexError):
            time_s = math.nan
        if not math.isfinite(time_s):
            hint = "lines are 'time rgb/A.png time depth/B.png'"
            raise InputError(path, f"holds the line {line[:40]!r}", hint)
        pairs.append((time_s, chosen[0]))
    return pairs


def _lines(path: Path) -> list[str]:
    return [line.strip() for line in read_lines(path) if not line.lstrip().startswith("#")]


def _images_of(line: str) -> list[str]:
    return [cell for cell in re.split(r"[\s,;]+", line) if cell.lower().endswith(IMAGE_SUFFIXES)]
