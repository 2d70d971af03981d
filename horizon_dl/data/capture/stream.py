"""Streams of frames in the order of their arrival: recorded sets, and videos with an attitude log.

Cameras with an autopilot are in `live`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.capture.camera import capture
from horizon_dl.data.frame import Frame, FrameEntry, Recording
from horizon_dl.data.images import load_frame, load_rgb
from horizon_dl.data.readers.parsing import MAX_GAP_S, by_time, column, read_table
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import interpolate, quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera

ATTITUDE_COLUMNS = ("time_s", "roll_rad", "pitch_rad", "yaw_rad")


@dataclass(frozen=True)
class Arrival:
    """One frame of a stream.

    Attributes:
        index: place in the stream, from 0.
        name: the frame's name.
        time_s: by the stream's clock.
        frame: with `up_cam` None where the attitude is not known and an image that may have another size than
            the camera's; None where the image cannot be read.
    """

    index: int
    name: str
    time_s: float
    frame: Frame | None


@dataclass(frozen=True)
class Stream:
    """Where frames come from.

    Attributes:
        name: of the data.
        format: name of the reader, `video` or `live`.
        camera: intrinsics of the upright images.
        count: number of frames, or None where that is not known.
        arrivals: frames from an index on, in order.
        live: frames come when they come, and do not wait.
        stop: end `arrivals` soon, from any thread, even while no frame comes.
    """

    name: str
    format: str
    camera: Camera
    count: int | None
    arrivals: Callable[[int], Iterator[Arrival]]
    live: bool = False
    stop: Callable[[], None] = lambda: None


def recorded_stream(recording: Recording) -> Stream:
    """The frames of a recorded set in time order."""

    def arrivals(start: int) -> Iterator[Arrival]:
        for index in range(start, len(recording.entries)):
            entry = recording.entries[index]
            yield Arrival(index, entry.name, entry.time_s, any_frame(recording, index))

    return Stream(recording.name, recording.format, recording.camera, len(recording.entries), arrivals)


def any_frame(recording: Recording, index: int) -> Frame | None:
    """A frame of a set as far as it can be had.

    A truth that cannot be read is left out; an image of another size than the camera's stays as it is; None
    where there is no image.
    """
    entry = recording.entries[index]
    for one in (entry, replace(entry, truth_path=None)):
        try:
            return load_frame(replace(recording, entries=[one]), 0)
        except FrameError:
            continue
    return _misfit(recording, entry)


def _misfit(recording: Recording, entry: FrameEntry) -> Frame | None:
    try:
        image = load_rgb(entry.image_path)
    except FrameError:
        return None
    image = np.ascontiguousarray(np.rot90(image, recording.rotate_quarter_turns_ccw))
    return Frame(entry.name, entry.time_s, image, recording.camera, entry.up_cam)


def video_stream(video: Path, attitude: Path, camera: Path) -> Stream:
    """A video file with the log of its attitude.

    Args:
        video: a file that OpenCV reads; its first frame is at time 0.
        attitude: CSV with the columns time_s, roll_rad, pitch_rad, yaw_rad: the body's (FRD in NED), at any
            rate; between samples it is interpolated, gaps over 0.2 s are not bridged.
        camera: camera.yaml.

    Raises:
        InputError: a file is missing or wrong.
    """
    if not video.is_file():
        raise InputError(video, "does not exist", "give a data set's folder or a video file")
    calibration = read_calibration(camera)
    times_s, quaternions = read_attitude(attitude)

    def arrivals(start: int) -> Iterator[Arrival]:
        for index, (time_s, image) in enumerate(_video_frames(video, calibration)):
            if index >= start:
                q = interpolate(times_s, quaternions, time_s, MAX_GAP_S)
                up_cam = None if q is None else up_in_camera(q, calibration.mount_rpy_rad)
                name = f"{index:06d}"
                yield Arrival(index, name, time_s, Frame(name, time_s, image, calibration.camera, up_cam))

    return Stream(video.stem, "video", calibration.camera, None, arrivals)


def read_attitude(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (N,), sorted, s, and quaternions (N, 4), (w, x, y, z), of an attitude log; NaN rows left out.

    Raises:
        InputError: missing, a column is missing, or no row has an attitude.
    """
    rows = read_table(path, ATTITUDE_COLUMNS[:3])
    times_s, roll, pitch, yaw = (column(path, rows, name) for name in ATTITUDE_COLUMNS)
    angles = np.stack([roll, pitch, np.nan_to_num(yaw)], axis=-1)
    times_s, angles = by_time(times_s, angles)
    if not len(times_s):
        raise InputError(path, "holds no attitude", "check that its values are numbers")
    return times_s, np.array([quaternion_from_rpy(*row) for row in angles])


def _video_frames(video: Path, calibration: Calibration) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    """Times from 0, s, and upright images; as fast as they are asked for, on a clock that only they move."""
    now_s = 0.0

    def wait(seconds: float) -> None:
        nonlocal now_s
        now_s += seconds

    turns = calibration.rotate_quarter_turns_ccw
    for picture in capture(str(video), lambda: now_s, rotate_quarter_turns_ccw=turns, wait=wait):
        yield picture.time_s, picture.image
