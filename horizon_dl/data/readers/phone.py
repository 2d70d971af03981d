"""Phones: the folder that MARS logger or Sensor Logger makes, or the film in it."""

from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude, Floats
from horizon_dl.data.attitude_logs import mars_logger, sensor_logger
from horizon_dl.data.attitude_logs.registry import read_attitude
from horizon_dl.data.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.containers import opened
from horizon_dl.data.film_frames import time_stamps
from horizon_dl.data.given import Given
from horizon_dl.data.readers.film import film_recording, films_in
from horizon_dl.data.readers.parsing import by_time, column, read_table
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera

NAME = "phone"
NEEDS = "the folder of MARS logger (movie.mp4, gyro_accel.csv), or of Sensor Logger with a film in Camera"
INERTIAL, STAMPS, METADATA = "gyro_accel.csv", "frame_timestamps.txt", "movie_metadata.csv"


def recognises(path: Path) -> bool:
    """Whether it is such a folder, or the film in one."""
    folder = path if path.is_dir() else path.parent
    is_film = path.is_dir() or path.suffix.lower() == ".mp4"
    mars = (folder / INERTIAL).is_file() and (folder / STAMPS).is_file()
    return is_film and (mars or _sensor_logger_folder(path) is not None)


def read(path: Path, given: Given) -> Recording:
    """The film with the rear camera's own attitude, unless --attitude names another one.

    Raises:
        InputError: there is no film, --camera is missing where the app does not tell it, or a table is wrong.
    """
    app = _sensor_logger_folder(path)
    return _mars(path, given) if app is None else _sensor_logger(path, app, given)


def _mars(path: Path, given: Given) -> Recording:
    folder = path if path.is_dir() else path.parent
    film = folder / "movie.mp4" if path.is_dir() else path
    _, shown_s = time_stamps(film)
    times_s, late_s = _exposed(folder, np.array(shown_s))
    camera = read_calibration(given.camera) if given.camera else _phone_camera(folder, film)
    kind = mars_logger.read(folder / INERTIAL) if given.attitude is None else read_attitude(given.attitude)
    return film_recording(film, NAME, given, camera, kind, (times_s + late_s).tolist())


def _exposed(folder: Path, shown_s: Floats) -> tuple[Floats, float]:
    """When each frame's exposure began, on the phone's clock, s, and how much later its middle row was exposed.

    Frames and stamps are counted from the film's first one and paired by time: either list may have one more.
    """
    rows = read_table(folder / STAMPS, ("Frame timestamp[nanosec]",))
    stamps_s, _ = by_time(
        column(folder / STAMPS, rows, "Frame timestamp[nanosec]") * 1e-9, np.zeros((len(rows), 1))
    )
    if not len(stamps_s):
        raise InputError(folder / STAMPS, "holds no time stamps", "record again")
    offsets_s = [stamps_s[first] - shown_s[0] for first in range(min(3, len(stamps_s)))]
    offset_s = min(
        offsets_s, key=lambda offset_s: float(np.abs(_nearest(stamps_s, shown_s + offset_s)).mean())
    )
    wanted = shown_s + offset_s
    apart = _nearest(stamps_s, wanted)
    step = float(np.median(np.diff(shown_s))) if len(shown_s) > 1 else 1.0
    late_s = 0.0
    if (folder / METADATA).is_file():
        metadata = read_table(folder / METADATA, ())
        names = ("Exposure time[nanosec]", "Frame readout time[nanosec]")
        parts = [column(folder / METADATA, metadata, name) for name in names]
        late_s = (
            sum(float(np.nan_to_num(np.nanmedian(part))) for part in parts if np.isfinite(part).any()) * 5e-10
        )
    return np.where(np.abs(apart) < step / 2, wanted + apart, wanted), late_s


def _nearest(stamps_s: Floats, wanted_s: Floats) -> Floats:
    """From each wanted time to the nearest stamp, s."""
    after = np.clip(np.searchsorted(stamps_s, wanted_s), 1, max(1, len(stamps_s) - 1))
    pair = np.stack([stamps_s[after - 1], stamps_s[np.minimum(after, len(stamps_s) - 1)]]) - wanted_s
    return np.asarray(np.take_along_axis(pair, np.abs(pair).argmin(axis=0)[None], axis=0)[0])


def _phone_camera(folder: Path, film: Path) -> Calibration:
    """A pinhole with the focal length that the app states, its centre in the middle."""
    path = folder / METADATA
    rows = read_table(path, ("fx[px]", "fy[px]"))
    focal = [float(np.nanmedian(column(path, rows, name))) for name in ("fx[px]", "fy[px]")]
    with opened(film) as container:
        frame = next(container.decode(video=0), None)
    if frame is None or not all(np.isfinite(focal)):
        raise InputError(path, "tells no focal length", "give the camera with --camera")
    across = round((frame.rotation or 0) / 90) % 2 == 1
    width, height = (frame.height, frame.width) if across else (frame.width, frame.height)
    camera = Camera("pinhole", width, height, *focal, (width - 1) / 2, (height - 1) / 2)
    return Calibration(camera)


def _sensor_logger_folder(path: Path) -> Path | None:
    """The export's folder of which the path is, or in which it lies."""
    for folder in (path, path.parent, path.parent.parent):
        if folder.is_dir() and sensor_logger.recognises(folder, b""):
            return folder
    return None


def _sensor_logger(path: Path, folder: Path, given: Given) -> Recording:
    """The film's name is the time at which its recording was asked for; pictures come up to a second later."""
    films = (
        [path]
        if path.is_file()
        else [film for place in (folder / "Camera", folder) if place.is_dir() for film in films_in(place)]
    )
    if not films:
        raise InputError(path, "has no film in Camera", "record with the camera on")
    if given.camera is None and given.needs_attitude:
        raise InputError(path, "does not tell its camera", "give it with --camera")
    _, shown_s = time_stamps(films[0])
    known = films[0].stem.isdigit() and len(films[0].stem) == 13
    start_s = int(films[0].stem) * 1e-3 if known else 0.0
    log: AttitudeLog | ConstantAttitude = (
        sensor_logger.read(folder) if given.attitude is None else read_attitude(given.attitude)
    )
    camera = None if given.camera is None else read_calibration(given.camera)
    return film_recording(films[0], NAME, given, camera, log, [start_s + time_s for time_s in shown_s])
