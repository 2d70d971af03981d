"""KITTI raw: any of its four cameras, rectified or not, attitude from oxts.

Geiger et al., Vision meets Robotics: The KITTI Dataset, IJRR 2013. DATA is the drive, its date folder, the
folder that holds the date folder, or one camera's folder (`image_03`); without, the left colour camera.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.picture_size import picture_size
from horizon_dl.data.convention import Convention, Reading
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, RangeUnit, image_recording
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import images_in, relative_name
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import rotation_from_quaternion, unit, yaw_of
from horizon_dl.readers.beside import files_beside
from horizon_dl.readers.kitti_calibration import CALIBRATION, read_kitti_camera
from horizon_dl.readers.kitti_times import attitudes_at_images, oxts_angles

Floats = NDArray[np.float64]

NAME = "kitti"
NEEDS = "image_02, oxts and calib_*.txt"
CAMERAS = ("02", "03", "00", "01")
"""Left colour, right colour, left grey, right grey: the order in which they are taken."""

CAMERA_HEIGHT_M = 1.65
RANGE_UNIT = RangeUnit(1 / 256, "ray")
FRD_FROM_FLU = np.diag([1.0, -1.0, -1.0])


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return bool(drives_below(folder))


def drives_below(folder: Path) -> list[tuple[Path, str]]:
    """Drives and the number of their camera: in the folder itself, or one or two levels below or above."""
    above = [folder.absolute().parent, folder.absolute().parent.parent]
    for place, child in zip(above, (folder.absolute(), above[0]), strict=True):
        number = child.name.removeprefix("image_")
        if number in CAMERAS and _images(place, number) and (place / "oxts").is_dir():
            return [(place, number)]
    if not folder.is_dir():
        return []
    places = sorted([folder, *folder.glob("*"), *folder.glob("*/*")])
    drives = [place for place in places if (place / "oxts").is_dir()]
    found = ((place, next((n for n in CAMERAS if _images(place, n)), "")) for place in drives)
    return [(place, number) for place, number in found if number]


def read(folder: Path, _: Given = NOTHING_GIVEN) -> Recording:
    """Opens one drive.

    Raises:
        InputError: no drive or several, a calibration file or field is missing, time stamps to pair images
            and oxts by are missing, or no frame has an attitude.
    """
    drives = drives_below(folder)
    if not drives:
        raise InputError(folder, "holds no KITTI drive", f"needed: {NEEDS}")
    if len(drives) > 1:
        listed = ", ".join(relative_name(drive, folder) for drive, _ in drives)
        raise InputError(folder, f"holds {len(drives)} drives: {listed}", "give the folder of one of them")
    drive, number = drives[0]
    images = _images(drive, number)
    one = read_kitti_camera(_calibration_of(drive), number, picture_size(images[:1]))
    times, attitudes = attitudes_at_images(drive, images)
    floor_up_cam = unit(one.cam_from_imu @ [0.0, 0.0, 1.0])
    names = [relative_name(image, drive) for image in images]
    truths, ranges = (files_beside(drive, kind, names) for kind in ("labels", "range"))
    frames = []
    for index, (image, attitude) in enumerate(zip(images, attitudes, strict=True)):
        up_cam = None if attitude is None else _up(one.cam_from_imu, attitude)
        yaw = None if attitude is None else yaw_of(attitude)
        as_read = None if attitude is None else oxts_angles(attitude)
        header = FrameHeader(
            names[index], times[index], up_cam, yaw, CAMERA_HEIGHT_M, floor_up_cam, as_read=as_read
        )
        frames.append((header, FrameFiles(image, truths[index], ranges[index])))
    others = [f"image_{other}" for other in CAMERAS if other != number and _images(drive, other)]
    note = f"camera image_{number}; {' and '.join(others)} can be given by folder" if others else ""
    return image_recording(
        drive.resolve().name,
        NAME,
        one.camera,
        frames,
        where=drive,
        attitude_from="oxts/data",
        range_unit=RANGE_UNIT,
        notes=(note,) if note else (),
        reading=Reading(Convention("flu", "z"), tuple((one.cam_from_imu @ FRD_FROM_FLU).ravel().tolist())),
    )


def _up(cam_from_imu: Floats, attitude: Floats) -> Floats:
    """The world's up in the camera, of an attitude body FRD to a world with z down."""
    return unit(cam_from_imu @ FRD_FROM_FLU @ rotation_from_quaternion(attitude).T @ [0.0, 0.0, -1.0])


def _images(drive: Path, number: str) -> list[Path]:
    folder = drive / f"image_{number}"
    return images_in(folder / "data") or images_in(folder)


def _calibration_of(drive: Path) -> Path:
    places = [drive, *list(drive.absolute().parents)[:2]]
    return next((place for place in places if (place / CALIBRATION).is_file()), places[1])
