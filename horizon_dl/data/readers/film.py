"""A film with the log of its attitude; the times of its frames are the container's own."""

from pathlib import Path

from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.attitude_logs.registry import read_attitude
from horizon_dl.data.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.film_frames import FilmLoader, time_stamps
from horizon_dl.data.given import Given
from horizon_dl.data.log_recording import headers_by_log
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError

NAME = "film"
NEEDS = "a film (mp4, mov, avi, mkv, webm), with --camera and --attitude"
SUFFIXES = {".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".ts", ".3gp", ".mts"}


def recognises(path: Path) -> bool:
    """Whether the path is a film's."""
    return path.is_file() and path.suffix.lower() in SUFFIXES


def read(path: Path, given: Given) -> Recording:
    """Opens a film; its frames are decoded when asked for, fastest in their order.

    Raises:
        InputError: it is no film, --camera or --attitude is missing or wrong, or film and log never meet.
    """
    calibration = None if given.camera is None else read_calibration(given.camera)
    log = None if given.attitude is None else read_attitude(given.attitude)
    if given.needs_attitude and (log is None or calibration is None):
        missing = "--attitude" if log is None else "--camera"
        raise InputError(path, f"is a film without {missing}", "a film needs --camera and --attitude")
    return film_recording(path, NAME, given, calibration, log)


def film_recording(
    path: Path,
    format: str,
    given: Given,
    calibration: Calibration | None,
    log: AttitudeLog | ConstantAttitude | None,
    seconds: list[float] | None = None,
) -> Recording:
    """A film as a recording.

    Args:
        path: of the film.
        format: name of its reader.
        given: what the user gave.
        calibration: of the camera, or None.
        log: attitudes, or None.
        seconds: times of the frames where they are known better than the film tells.
    """
    stamps, shown_s = time_stamps(path)
    times_s = shown_s if seconds is None else seconds[: len(stamps)]
    stamps = stamps[: len(times_s)]
    names = [f"{index:06d}" for index in range(len(stamps))]
    headers, moved, notes = headers_by_log(path, names, times_s, calibration, log, given)
    return Recording(
        path.stem,
        format,
        None if calibration is None else calibration.camera,
        headers,
        FilmLoader(path, tuple(stamps), 0 if calibration is None else calibration.rotate_quarter_turns_ccw),
        None if calibration is None else calibration.mount_rpy_rad,
        notes,
        attitudes=moved,
    )
