"""Plain pictures: a folder of images, or one image, with nothing known of camera or attitude."""

from pathlib import Path

from horizon_dl.data.attitude_log import ConstantAttitude, read_attitude
from horizon_dl.data.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.image_folder import FrameFiles, ImageLoader, image_recording
from horizon_dl.data.readers.parsing import IMAGE_SUFFIXES, images_in
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError

NAME = "pictures"
NEEDS = "images (predict alone: nothing is known of their attitude)"


def recognises(path: Path) -> bool:
    """Whether the path is an image or a folder with images."""
    return bool(picture_paths(path))


def read(path: Path, given: Given) -> Recording:
    """The images by name.

    Raises:
        InputError: an attitude is needed, and pictures have none.
    """
    constant = None if given.attitude is None else read_attitude(given.attitude)
    if isinstance(constant, ConstantAttitude) and given.camera is not None:
        return _with_attitude(path, constant, read_calibration(given.camera))
    if given.needs_attitude:
        raise InputError(
            path,
            "holds pictures without any attitude: nothing says where their horizon lies",
            "add frames.csv and camera.yaml, or give --camera and --attitude constant:ROLL,PITCH",
        )
    paths = picture_paths(path)
    headers = [FrameHeader(one.name, float(index)) for index, one in enumerate(paths)]
    files = tuple(FrameFiles(one) for one in paths)
    return Recording(path.resolve().name, NAME, None, headers, ImageLoader(files))


def _with_attitude(path: Path, attitude: ConstantAttitude, calibration: Calibration) -> Recording:
    mount = calibration.mount_rpy_rad
    return image_recording(
        path.resolve().name,
        NAME,
        calibration.camera,
        [
            (attitude.header(one.name, float(index), mount), FrameFiles(one))
            for index, one in enumerate(picture_paths(path))
        ],
        where=path,
        attitude_from="--attitude",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        mount_rpy_rad=mount,
    )


def picture_paths(path: Path) -> list[Path]:
    """The images of a folder by name, or the one image that `path` is; empty where there is none."""
    if path.is_file():
        return [path] if path.suffix.lower() in IMAGE_SUFFIXES else []
    return images_in(path)
