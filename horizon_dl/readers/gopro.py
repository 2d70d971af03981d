"""A GoPro's film: its attitude is in it; its camera is given."""

from pathlib import Path

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs import gopro_track
from horizon_dl.logs.camera_and_log import camera_and_log
from horizon_dl.readers import film

NAME = "gopro"
NEEDS = "a GoPro's film with its track of sensors, with --camera"


def recognises(path: Path) -> bool:
    """Whether it is a film with GoPro's track."""
    if not film.recognises(path) or path.is_dir():
        return False
    with path.open("rb") as file:
        return gopro_track.recognises(path, file.read(16))


def read(path: Path, given: Given) -> Recording:
    """The film with the camera's own attitude, unless --attitude names another one.

    Raises:
        InputError: --camera is missing, or the track has neither gravity nor inertial sensors.
    """
    place = given.camera or film.camera_beside(path)
    if place is None:
        if not given.needs_attitude:
            return film.film_recording(path, NAME, given, None, None)
        problem = "is a GoPro's film: its attitude is inside, its camera is not"
        hint = "give --camera FILE (pinhole, fx and fy of half the width for wide, all of it for linear)"
        raise InputError(path, problem, hint)
    calibration = read_calibration(place, imu_axes=given.imu_axes)
    if given.attitude is None:
        return film.film_recording(path, NAME, given, calibration, gopro_track.read(path))
    calibration, log = camera_and_log(calibration, given.attitude, given)
    return film.film_recording(path, NAME, given, calibration, log)
