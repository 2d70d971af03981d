"""Sensor Logger (Android, iOS): the export's folder with a film in `Camera`."""

from dataclasses import replace
from pathlib import Path

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.film_frames import time_stamps
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs import sensor_logger
from horizon_dl.logs.camera_and_log import camera_and_log, check_camera
from horizon_dl.readers import image_files
from horizon_dl.readers.film import SUFFIXES, camera_beside, film_recording, films_in

NAME = "sensor_logger"
CAMERA = "Camera"
NEEDS = "Sensor Logger's folder with Gravity.csv and a film or pictures in Camera, with --camera"
LATE = (
    "The film's name is when the recording was asked for; its pictures begin up to a second later: "
    "--time-offset=auto finds it."
)


def recognises(path: Path) -> bool:
    """Whether it is an export's folder with a film or pictures, or the film in one."""
    folder = _folder(path)
    return folder is not None and (
        path.suffix.lower() in SUFFIXES or (path.is_dir() and bool(_films(folder) or _pictures(folder)))
    )


def read(path: Path, given: Given) -> Recording:
    """The film, or the pictures, with the rear camera's own attitude, unless --attitude names another one.

    Raises:
        InputError: there is no film, --camera is missing, or a table is wrong.
    """
    folder = _folder(path)
    if folder is not None and path.is_dir() and not _films(folder) and _pictures(folder):
        camera = given.camera or camera_beside(_pictures(folder)[0])
        if camera is None and given.needs_attitude:
            raise InputError(path, "does not tell its camera", "give it with --camera")
        own = None if camera is None else str(folder)
        told = replace(given, camera=camera, attitude=given.attitude or own)
        return replace(image_files.read(folder / CAMERA, told), name=folder.resolve().name)
    films = [path] if path.is_file() else [] if folder is None else _films(folder)
    if folder is None or not films:
        raise InputError(path, "has no film in Camera", "record with the camera on")
    film = films[0]
    camera = given.camera or camera_beside(film) or camera_beside(folder / film.name)
    if camera is None and given.needs_attitude:
        raise InputError(path, "does not tell its camera", "give it with --camera")
    _, shown_s = time_stamps(film)
    named = film.stem.isdigit() and len(film.stem) == 13
    start_s = int(film.stem) * 1e-3 if named else 0.0
    calibration = None if camera is None else read_calibration(camera, imu_axes=given.imu_axes)
    check_camera(film, calibration, given)
    log: AttitudeLog | ConstantAttitude | None = None
    if given.attitude is None:
        log = sensor_logger.read(folder)
    elif calibration is not None:
        calibration, log = camera_and_log(calibration, given.attitude, given)
    times_s = [start_s + time_s for time_s in shown_s]
    recording = film_recording(film, NAME, given, calibration, log, times_s)
    return replace(recording, notes=(*recording.notes, LATE)) if named else recording


def _folder(path: Path) -> Path | None:
    """The export's folder that the path is, or in which it lies."""
    for folder in (path,) if path.is_dir() else (path.parent, path.parent.parent):
        if sensor_logger.recognises(folder, b""):
            return folder
    return None


def _films(folder: Path) -> list[Path]:
    return [film for place in (folder / CAMERA, folder) if place.is_dir() for film in films_in(place)]


def _pictures(folder: Path) -> list[Path]:
    return image_files.picture_paths(folder / CAMERA) if (folder / CAMERA).is_dir() else []
