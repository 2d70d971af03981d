"""Plain pictures: a folder of images, or one image, with nothing known of camera or attitude."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.image_folder import FrameFiles, image_loader, image_recording
from horizon_dl.data.picture_times import by_shutter, picture_times
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import IMAGE_SUFFIXES, images_in, natural, relative_name
from horizon_dl.errors import InputError
from horizon_dl.logs.camera_and_log import camera_and_log, check_camera
from horizon_dl.logs.log_recording import headers_by_log
from horizon_dl.readers.times_beside import times_beside

NAME = "pictures"
NEEDS = "images (predict alone: nothing is known of their attitude)"
NO_PICTURES = {"labels", "depth", "range", "masks", "__MACOSX"}


def recognises(path: Path) -> bool:
    """Whether the path is an image or a folder with images."""
    return bool(picture_paths(path))


def read(path: Path, given: Given) -> Recording:
    """The images by name; with --camera and --attitude, of a log or constant, they have an attitude.

    Raises:
        InputError: an attitude is needed, and pictures have none, or no times to find it in the log.
    """
    calibration = None if given.camera is None else read_calibration(given.camera, imu_axes=given.imu_axes)
    check_camera(path, calibration, given)
    if calibration is not None and given.attitude is not None:
        calibration, attitude = camera_and_log(calibration, given.attitude, given)
        if isinstance(attitude, ConstantAttitude):
            return _with_attitude(path, attitude, calibration)
        return _with_log(path, attitude, calibration, given)
    if given.needs_attitude:
        raise InputError(
            path,
            "holds pictures without any attitude: nothing says where their horizon lies",
            "add frames.csv and camera.yaml, or give --camera, and --attitude LOG or constant:ROLL,PITCH",
        )
    paths = picture_paths(path)
    headers = [FrameHeader(name, float(index)) for index, name in enumerate(_names(path, paths))]
    load, notes = image_loader(tuple(FrameFiles(one) for one in paths))
    return Recording(path.resolve().name, NAME, None, headers, load, notes=notes)


def _with_log(path: Path, log: AttitudeLog, calibration: Calibration, given: Given) -> Recording:
    """Pictures and a log, paired by time."""
    paths = picture_paths(path)
    times_s = picture_times(paths)
    listed = times_beside(path, paths, given) if times_s is None and path.is_dir() else None
    of_list: tuple[str, ...] = ()
    if listed is not None:
        paths, times_s, of_list = listed
    if times_s is None:
        raise InputError(
            path,
            "holds pictures whose names and EXIF tell no times: nothing pairs them with the log",
            "name them by their time, or add timestamps.txt, a line for each, or a table of image and time_s",
        )
    order = np.argsort(times_s, kind="stable")
    paths, times_s = [paths[index] for index in order], times_s[order]
    at_shutter = None if log.shutter is None else by_shutter(times_s, log.shutter.times_s)
    if log.shutter is not None and at_shutter is not None:
        log, times_s = log.shutter, at_shutter
    names = [one.name for one in paths]
    try:
        headers, moved, notes = headers_by_log(path, names, times_s.tolist(), calibration, log, given)
    except InputError as error:
        if log.shutter is None:
            raise
        taken = (
            f"holds {len(paths)} pictures, and the log tells of {len(log.shutter.times_s)} that were taken"
        )
        raise InputError(
            path, f"{taken}; they {error.args[1].removeprefix('and its log ')}", error.args[2]
        ) from None
    return replace(
        image_recording(
            path.resolve().name,
            NAME,
            calibration.camera,
            zip(headers, map(FrameFiles, paths), strict=True),
            where=path,
            attitude_from="--attitude",
            rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
            mount_rpy_rad=calibration.known_mount,
            notes=(*calibration.notes, *of_list, *notes),
            reading=reading_with(Convention(), calibration.mount_rpy_rad),
            needs_attitude=not given.find_offset,
        ),
        attitudes=moved,
    )


def _with_attitude(path: Path, attitude: ConstantAttitude, calibration: Calibration) -> Recording:
    mount, paths = calibration.mount_rpy_rad, picture_paths(path)
    return image_recording(
        path.resolve().name,
        NAME,
        calibration.camera,
        [
            (attitude.header(name, float(index), mount), FrameFiles(one))
            for index, (name, one) in enumerate(zip(_names(path, paths), paths, strict=True))
        ],
        where=path,
        attitude_from="--attitude",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        mount_rpy_rad=mount,
    )


def picture_paths(path: Path) -> list[Path]:
    """The images of a folder by name, else of the folders in it; or the one image that `path` is."""
    if path.is_file():
        return [path] if path.suffix.lower() in IMAGE_SUFFIXES else []
    direct = images_in(path)
    if direct or not path.is_dir():
        return direct
    folders = sorted((p for p in path.iterdir() if p.is_dir() and p.name not in NO_PICTURES), key=_by_name)
    return [image for folder in folders for image in images_in(folder)]


def _by_name(path: Path) -> list[tuple[int, str]]:
    return natural(path.name)


def _names(path: Path, paths: list[Path]) -> list[str]:
    """Of the pictures: their paths within the folder."""
    return [one.name if path.is_file() else relative_name(one, path) for one in paths]
