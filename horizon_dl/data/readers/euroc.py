"""EuRoC (ASL folders): grey images of cam0, attitude from the ground truth, else from the IMU.

Burri et al., The EuRoC micro aerial vehicle datasets, IJRR 2016. DATA is the sequence or its `mav0`.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.calibration.calibration import Fields, load_yaml
from horizon_dl.data.calibration.calibration_kinds import body_from_camera, euroc_sensor
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.imu import estimate_up
from horizon_dl.data.readers.parsing import (
    MAX_GAP_S,
    beside,
    by_time,
    check_overlap,
    inside_folder,
    read_lines,
    read_numbers,
    relative_name,
    usable_quaternions,
    whole_number,
)
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import bracket, interpolate, rotation_from_quaternion, unit

Floats = NDArray[np.float64]

NAME = "euroc"
NEEDS = "mav0/cam0 (data, data.csv, sensor.yaml) and mav0/state_groundtruth_estimate0 or mav0/imu0"
NANOSECOND = 1e-9
MOST_IMU = 1e4
"""rad/s and m/s^2: no IMU measures more."""
UP_WORLD = np.array([0.0, 0.0, 1.0])


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return _root(folder) is not None


def read(folder: Path, _: Given = NOTHING_GIVEN) -> Recording:
    """Opens one sequence.

    Raises:
        InputError: a file or field is missing, or attitude and images never meet in time.
    """
    root = _root(folder)
    if root is None:
        raise InputError(folder, "holds no EuRoC sequence", f"needed: {NEEDS}")
    sensor = root / "cam0" / "sensor.yaml"
    fields = Fields(sensor, load_yaml(sensor))
    camera = euroc_sensor(fields).camera
    cam_from_body = body_from_camera(fields).T
    images = read_images(root / "cam0" / "data.csv")
    image_times = np.array([stamp * NANOSECOND for stamp, _ in images])
    source, up_body, note = up_in_body(root, image_times)
    frames = []
    for (stamp, name), up in zip(images, up_body, strict=True):
        path = inside_folder(root / "cam0" / "data.csv", root / "cam0" / "data", name)
        up_cam = None if up is None else unit(cam_from_body @ up)
        header = FrameHeader(relative_name(path, folder), stamp * NANOSECOND, up_cam)
        labels = beside(root, "labels", path.stem) or beside(root.parent, "labels", path.stem)
        frames.append((header, FrameFiles(path, labels)))
    return image_recording(
        root.resolve().parent.name,
        NAME,
        camera,
        frames,
        where=source,
        attitude_from=source.parent.name,
        notes=(note,) if note else (),
    )


def up_in_body(root: Path, image_times_s: Floats) -> tuple[Path, list[Floats | None], str]:
    """The file that gave it, the world's up in the body at each time (None outside of the data), and a note.

    Raises:
        InputError: neither ground truth nor IMU, or their times never meet the images'.
    """
    truth, imu = root / "state_groundtruth_estimate0" / "data.csv", root / "imu0" / "data.csv"
    if truth.is_file():
        samples = read_numbers(truth, 8)
        samples = samples[usable_quaternions(samples[:, 4:8])]
        times, quaternions = by_time(samples[:, 0] * NANOSECOND, samples[:, 4:8])
        check_overlap(truth, image_times_s, times)
        attitudes = (interpolate(times, quaternions, t, MAX_GAP_S) for t in image_times_s.tolist())
        ups = [None if q is None else rotation_from_quaternion(q).T @ UP_WORLD for q in attitudes]
        return truth, ups, ""
    if not imu.is_file():
        raise InputError(root, "has neither state_groundtruth_estimate0 nor imu0", "copy one of them")
    samples = read_numbers(imu, 7)
    possible = (np.abs(samples[:, 1:7]) < MOST_IMU).all(axis=-1)
    times, rates = by_time(samples[possible, 0] * NANOSECOND, samples[possible, 1:7])
    check_overlap(imu, image_times_s, times)
    up_samples = estimate_up(times, rates[:, :3], rates[:, 3:])
    ups = [_up_at(times, up_samples, t) for t in image_times_s.tolist()]
    return imu, ups, "no ground truth: the attitude is estimated from the IMU"


def read_images(path: Path) -> list[tuple[int, str]]:
    """Times (ns) and names of the camera's data.csv.

    Raises:
        InputError: missing, or a line is not `time,name`.
    """
    pairs = []
    for line in read_lines(path):
        if line.lstrip().startswith("#"):
            continue
        stamp, _, name = (part.strip() for part in line.partition(","))
        number = whole_number(stamp)
        if number is None or not name:
            raise InputError(
                path, f"holds the line {line.strip()[:40]!r}", "lines are 'nanoseconds,filename'"
            )
        pairs.append((number, name))
    return pairs


def _up_at(times_s: Floats, ups: Floats, time_s: float) -> Floats | None:
    place = bracket(times_s, time_s, MAX_GAP_S)
    if place is None:
        return None
    index, fraction = place
    after = min(index + 1, len(ups) - 1)
    up = (1 - fraction) * ups[index] + fraction * ups[after]
    return unit(up) if np.linalg.norm(up) > 0.5 else None  # an IMU that gives zeros only has no up


def _root(folder: Path) -> Path | None:
    places = (folder / "mav0", folder)
    return next((place for place in places if (place / "cam0" / "data.csv").is_file()), None)
