"""EuRoC (ASL folders), TUM-VI and others of that layout: attitude from a ground truth, else from the IMU.

Burri et al., The EuRoC micro aerial vehicle datasets, IJRR 2016; Schubert et al., The TUM VI benchmark, 2018.
DATA is the sequence, its `mav0`, or one camera's folder (`cam1`); without, the first camera.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.convention import Convention, Reading
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.imu import estimate_up
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import (
    MOST_INERTIAL,
    by_time,
    check_overlap,
    images_in,
    inside_folder,
    read_lines,
    read_numbers,
    relative_name,
    whole_number,
)
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import MAX_GAP_S, bracket, unit
from horizon_dl.readers.beside import files_beside
from horizon_dl.readers.euroc_camera import read_euroc_camera
from horizon_dl.readers.euroc_poses import Attitudes, find_poses, read_attitudes, seconds_of

Floats = NDArray[np.float64]

NAME = "euroc"

BODY = Convention(up="z")
"""The numbers' order, and the world; where the body's axes point is in the calibration."""

NEEDS = "mav0 with cam0, and imu0 or a ground truth"


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return _place(folder) is not None


def read(folder: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens one sequence.

    Raises:
        InputError: a file or field is missing, or attitude and images never meet in time.
    """
    place = _place(folder)
    if place is None:
        raise InputError(folder, "holds no EuRoC sequence", f"needed: {NEEDS}")
    root, cam = place
    images = list_images(cam)
    image_times = seconds_of(np.array([stamp for stamp, _ in images], np.float64))
    source, told, note = attitudes_of(root, image_times)
    known = [up for up in told.ups if up is not None]
    camera = read_euroc_camera(root, cam, np.array(known).reshape(-1, 3), given)
    paths = [path for _, path in images]
    names = [relative_name(path, root) for path in paths]
    labels = root if (root / "labels").is_dir() else root.parent
    truths = files_beside(labels, "labels", names)
    frames = []
    for index, up in enumerate(told.ups):
        up_cam = None if up is None else unit(camera.cam_from_body @ up)
        header = FrameHeader(names[index], float(image_times[index]), up_cam, as_read=told.as_read[index])
        frames.append((header, FrameFiles(paths[index], truths[index])))
    home = root.resolve()
    return image_recording(
        home.parent.name if home.name == "mav0" else home.name,
        NAME,
        camera.camera,
        frames,
        where=source,
        attitude_from=source.parent.name,
        notes=tuple(one for one in (note, camera.note) if one),
        reading=Reading(BODY, tuple((camera.cam_from_body @ told.imu_from_body).ravel().tolist()))
        if any(one is not None for one in told.as_read)
        else None,
    )


def attitudes_of(root: Path, image_times_s: Floats) -> tuple[Path, Attitudes, str]:
    """The file that gave them, the attitudes at each time, and a note; of an IMU only the ups are known.

    Raises:
        InputError: neither ground truth nor IMU, or their times never meet the images'.
    """
    poses, imu = find_poses(root), root / "imu0" / "data.csv"
    if poses is not None:
        return poses, read_attitudes(poses, image_times_s), ""
    if not imu.is_file():
        raise InputError(root, "has neither state_groundtruth_estimate0, mocap0 nor imu0", "copy one of them")
    samples = read_numbers(imu, 7)
    times, rates = by_time(seconds_of(samples[:, 0]), samples[:, 1:7], MOST_INERTIAL)
    check_overlap(imu, image_times_s, times)
    up_samples = estimate_up(times, rates[:, :3], rates[:, 3:])
    ups = [_up_at(times, up_samples, t) for t in image_times_s.tolist()]
    told = Attitudes(ups, [None] * len(ups), np.eye(3))
    return imu, told, "no ground truth: the attitude is estimated from the IMU"


def list_images(cam: Path) -> list[tuple[int, Path]]:
    """Times (ns) and files of a camera's `data.csv`; without it, the files that are named by their time.

    Raises:
        InputError: a line is not `time,name`.
    """
    path = cam / "data.csv"
    if not path.is_file():
        numbered = ((whole_number(image.stem), image) for image in images_in(cam / "data"))
        return [(number, image) for number, image in numbered if number is not None]
    pairs: list[tuple[int, Path]] = []
    for line in read_lines(path):
        if line.lstrip().startswith("#"):
            continue
        stamp, *rest = re.split(r"[,;\s]+", line.strip(), maxsplit=1)
        name = rest[0].strip(" ,;") if rest else ""
        number = whole_number(stamp)
        if number is None or not name:
            if not pairs and not re.match(r"[\d.+-]", stamp):
                continue  # a header without its sign
            raise InputError(
                path, f"holds the line {line.strip()[:40]!r}", "lines are 'nanoseconds,filename'"
            )
        pairs.append((number, inside_folder(path, cam / "data", name)))
    return pairs


def _up_at(times_s: Floats, ups: Floats, time_s: float) -> Floats | None:
    place = bracket(times_s, time_s, MAX_GAP_S)
    if place is None:
        return None
    index, fraction = place
    after = min(index + 1, len(ups) - 1)
    up = (1 - fraction) * ups[index] + fraction * ups[after]
    return unit(up) if np.linalg.norm(up) > 0.5 else None  # an IMU that gives zeros only has no up


def _place(folder: Path) -> tuple[Path, Path] | None:
    """The folder of all sensors, and that of the camera."""
    absolute = folder.absolute()
    if re.fullmatch(r"cam\d", absolute.name) and _is_camera(absolute):
        return absolute.parent, absolute
    for root in (folder / "mav0", folder):
        cameras = sorted(root.glob("cam[0-9]")) if root.is_dir() else []
        found = next((cam for cam in cameras if _is_camera(cam)), None)
        if found is not None:
            return root, found
    return None


def _is_camera(cam: Path) -> bool:
    return (cam / "data").is_dir() and ((cam / "data.csv").is_file() or bool(images_in(cam / "data")))
