"""A film with the log of its attitude; the times of its frames are the container's own."""

from pathlib import Path

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.calibration.mount import AxesNotStatedError
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.film_frames import FilmLoader, time_stamps
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import images_in
from horizon_dl.errors import InputError
from horizon_dl.logs.camera_and_log import camera_and_log, check_camera
from horizon_dl.logs.log_recording import headers_by_log

NAME = "film"
NEEDS = "a film (mp4, mov, avi, mkv, webm), with --camera and --attitude"
SUFFIXES = {".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".ts", ".3gp", ".mts"}


LOG_SUFFIXES = (".ulg", ".bin", ".log", ".csv", ".srt", ".gcsv")
"""Of a log beside the film that has its name; in the order in which they are looked for."""


def recognises(path: Path) -> bool:
    """Whether the path is a film's, or that of a folder with one film and no images."""
    if path.is_dir():
        return len(films_in(path)) == 1 and not images_in(path)
    return path.is_file() and path.suffix.lower() in SUFFIXES


def films_in(folder: Path) -> list[Path]:
    """Films of a folder, by name."""
    return sorted(
        one for one in folder.iterdir() if one.suffix.lower() in SUFFIXES and not one.name.startswith(".")
    )


def read(path: Path, given: Given) -> Recording:
    """Opens a film; its frames are decoded when asked for, fastest in their order.

    A log of the film's name, and a `camera.yaml`, are taken from beside it where none are given.

    Raises:
        InputError: it is no film, --camera or --attitude is missing or wrong, or film and log never meet.
    """
    film = films_in(path)[0] if path.is_dir() else path
    camera = given.camera or camera_beside(film)
    calibration = None if camera is None else read_calibration(camera, imu_axes=given.imu_axes)
    attitude = given.attitude or log_beside(film)
    if given.needs_attitude and (attitude is None or calibration is None):
        missing = "--attitude" if attitude is None else "--camera"
        raise InputError(film, f"is a film without {missing}", "a film needs --camera and --attitude")
    check_camera(film, calibration, given)
    if attitude is None or calibration is None:
        return film_recording(film, NAME, given, calibration, None)
    try:
        calibration, log = camera_and_log(calibration, attitude, given)
    except AxesNotStatedError:
        if given.needs_attitude or given.attitude is not None:
            raise
        log = None  # it only lies beside the film, and is not needed
    return film_recording(film, NAME, given, calibration, log)


def camera_beside(film: Path) -> Path | None:
    """The camera's file in the film's folder, if there is one."""
    found = [film.with_suffix(".yaml"), film.parent / "camera.yaml"]
    return next((one for one in found if one.is_file()), None)


def log_beside(film: Path) -> str | None:
    """The log in the film's folder that has the film's name, if there is one."""
    kin = [one for one in film.parent.iterdir() if one.stem == film.stem]
    for suffix in LOG_SUFFIXES:
        for one in kin:
            if one.suffix.lower() == suffix:
                return str(one)
    return None


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
        None if calibration is None else calibration.known_mount,
        notes if calibration is None else (*calibration.notes, *notes),
        reading=None if calibration is None else reading_with(Convention(), calibration.mount_rpy_rad),
        attitudes=moved,
    )
