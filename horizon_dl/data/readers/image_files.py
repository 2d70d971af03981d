"""Plain pictures: a folder of images, or one image, with nothing known of camera or attitude."""

from pathlib import Path

from horizon_dl.data.attitude_log import ConstantAttitude, read_attitude
from horizon_dl.data.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.image_folder import FrameFiles, image_loader, image_recording
from horizon_dl.data.readers.parsing import IMAGE_SUFFIXES, images_in, natural, relative_name
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError

NAME = "pictures"
NEEDS = "images (predict alone: nothing is known of their attitude)"
NO_PICTURES = {"labels", "depth", "range", "masks", "__MACOSX"}


def recognises(path: Path) -> bool:
    """Whether the path is an image or a folder with images."""
    return bool(picture_paths(path))


def read(path: Path, given: Given) -> Recording:
    """The images by name.

    Raises:
        InputError: an attitude is needed, and pictures have none.
    """
    constant = None if given.attitude is None else read_attitude(given.attitude, given)
    if isinstance(constant, ConstantAttitude) and given.camera is not None:
        return _with_attitude(path, constant, read_calibration(given.camera, imu_axes=given.imu_axes))
    if given.needs_attitude:
        raise InputError(
            path,
            "holds pictures without any attitude: nothing says where their horizon lies",
            "add frames.csv and camera.yaml, or give --camera and --attitude constant:ROLL,PITCH",
        )
    paths = picture_paths(path)
    headers = [FrameHeader(name, float(index)) for index, name in enumerate(_names(path, paths))]
    load, notes = image_loader(tuple(FrameFiles(one) for one in paths))
    return Recording(path.resolve().name, NAME, None, headers, load, notes=notes)


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
