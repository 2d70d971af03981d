"""MARS logger (Android): a film, its frames' time stamps, gyroscope, accelerometer, focal length."""

from pathlib import Path

import numpy as np

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude, Floats
from horizon_dl.data.containers import first_frame
from horizon_dl.data.film_frames import time_stamps
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import column, read_table
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera
from horizon_dl.logs.attitude_logs import mars_logger
from horizon_dl.logs.camera_and_log import camera_and_log
from horizon_dl.readers.film import film_recording

NAME = "mars"
NEEDS = "MARS logger's folder with movie.mp4, frame_timestamps.txt, gyro_accel.csv, movie_metadata.csv"
FILM, INERTIAL, STAMPS, METADATA = (
    "movie.mp4",
    "gyro_accel.csv",
    "frame_timestamps.txt",
    "movie_metadata.csv",
)
STAMP = "Frame timestamp[nanosec]"
EXPOSURE = ("Exposure time[nanosec]", "Frame readout time[nanosec]")


def recognises(path: Path) -> bool:
    """Whether it is such a folder, or the film in one."""
    folder = path if path.is_dir() else path.parent
    named = path.is_dir() or path.name.lower() == FILM
    return named and all((folder / name).is_file() for name in (FILM, INERTIAL, STAMPS))


def read(path: Path, given: Given) -> Recording:
    """The film with the rear camera's own attitude, unless --attitude names another one.

    Raises:
        InputError: a table is missing or wrong, or the focal length is neither told nor given.
    """
    folder = path if path.is_dir() else path.parent
    film = folder / FILM
    _, shown_s = time_stamps(film)
    camera = (
        read_calibration(given.camera, imu_axes=given.imu_axes) if given.camera else _own_camera(folder, film)
    )
    if given.attitude is None:
        log: AttitudeLog | ConstantAttitude = mars_logger.read(folder / INERTIAL)
    else:
        camera, log = camera_and_log(camera, given.attitude, given)
    times_s = exposure_starts(np.array(shown_s), _stamps(folder)) + _late_s(folder)
    return film_recording(film, NAME, given, camera, log, times_s.tolist())


def exposure_starts(shown_s: Floats, stamps_s: Floats) -> Floats:
    """When the exposures of a film's frames (n,) began, of the app's stamps (m,), s.

    Paired by the pauses between them: the app may have begun its list a frame or two before its film.

    Example:
        >>> exposure_starts(np.array([0.0, 0.1, 0.3]), np.array([7.0, 7.05, 7.15, 7.36])).tolist()
        [7.05, 7.15, 7.36]
    """
    offsets_s = stamps_s[:3] - shown_s[0]
    misfits = [float(np.abs(_to_nearest(stamps_s, shown_s + offset_s)).mean()) for offset_s in offsets_s]
    wanted_s = shown_s + offsets_s[int(np.argmin(misfits))]
    step_s = float(np.median(np.diff(shown_s))) if len(shown_s) > 1 else 1.0
    apart_s = _to_nearest(stamps_s, wanted_s)
    return np.asarray(np.where(np.abs(apart_s) < step_s / 2, wanted_s + apart_s, wanted_s))


def _to_nearest(stamps_s: Floats, wanted_s: Floats) -> Floats:
    """From each time asked for to the nearest stamp, s."""
    after = np.clip(np.searchsorted(stamps_s, wanted_s), 0, len(stamps_s) - 1)
    later, earlier = stamps_s[after] - wanted_s, stamps_s[np.maximum(after - 1, 0)] - wanted_s
    return np.asarray(np.where(np.abs(later) <= np.abs(earlier), later, earlier))


def _stamps(folder: Path) -> Floats:
    path = folder / STAMPS
    stamps_s = column(path, read_table(path, (STAMP,)), STAMP) * 1e-9
    stamps_s = np.sort(stamps_s[np.isfinite(stamps_s)])
    if not len(stamps_s):
        raise InputError(path, "holds no time stamps", "record again")
    return stamps_s


def _late_s(folder: Path) -> float:
    """From the start of a frame's exposure to the middle of its middle row's, s."""
    path = folder / METADATA
    if not path.is_file():
        return 0.0
    rows = read_table(path, ())
    parts = [column(path, rows, name) for name in EXPOSURE]
    return float(sum(np.nanmedian(part) for part in parts if np.isfinite(part).any())) * 0.5e-9


def _own_camera(folder: Path, film: Path) -> Calibration:
    """A pinhole with the focal length that the app states, its centre in the middle."""
    path = folder / METADATA
    if not path.is_file():
        raise InputError(path, "is missing", "restore it, or give the camera with --camera")
    rows = read_table(path, ("fx[px]", "fy[px]"))
    fx, fy = (column(path, rows, name) for name in ("fx[px]", "fy[px]"))
    fx, fy = fx[np.isfinite(fx) & (fx > 0)], fy[np.isfinite(fy) & (fy > 0)]
    if not (len(fx) and len(fy)):
        raise InputError(path, "tells no focal length", "give the camera with --camera")
    frame = first_frame(film)
    across = round((frame.rotation or 0) / 90) % 2 == 1
    width, height = (frame.height, frame.width) if across else (frame.width, frame.height)
    focal = float(np.median(fx)), float(np.median(fy))
    return Calibration(Camera("pinhole", width, height, *focal, (width - 1) / 2, (height - 1) / 2))
