"""DJI's photos: each carries its gimbal's attitude (XMP), which is the camera's own against the world."""

import math
from pathlib import Path

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.calibration.limits import MAX_SIDE_PX
from horizon_dl.calibration.picture_size import size_of
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.photo_tags import dji_tags, exif_time_s, focal_px
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import MountRpy, quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.readers.image_files import picture_paths

NAME = "dji_photos"
NEEDS = "DJI's photos with the gimbal's angles in their XMP"
MOST_ANGLE = 2 * math.pi
ANGLES = ("GimbalRollDegree", "GimbalPitchDegree", "GimbalYawDegree")


def recognises(path: Path) -> bool:
    """Whether the image, or a folder's first one, has a gimbal's attitude in it."""
    paths = picture_paths(path)
    return bool(paths) and ANGLES[1] in dji_tags(paths[0])


def read(path: Path, given: Given) -> Recording:
    """The photos, with Gimbal*; Flight* are the drone's own angles against the world, and are not added.

    Past the nadir roll is written as 180 degrees, with the heading turned: the same attitude in other words.

    Raises:
        InputError: no photo tells an attitude, or the focal length is neither told nor given.
    """
    paths = picture_paths(path)
    calibration = (
        _own_camera(paths[0])
        if given.camera is None
        else read_calibration(given.camera, imu_axes=given.imu_axes)
    )
    mount = calibration.mount_rpy_rad
    notes: tuple[str, ...] = ("Attitude from the gimbal (GimbalRoll, Pitch, YawDegree).",)
    if given.camera is None:
        notes = (*notes, "Focal length from the photo's own tags, no distortion known: --camera is better.")
    frames = [(_header(one, index, mount), FrameFiles(one)) for index, one in enumerate(paths)]
    return image_recording(
        path.resolve().stem,
        NAME,
        calibration.camera,
        frames,
        where=path,
        attitude_from="the gimbal's angles",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        mount_rpy_rad=mount,
        notes=notes,
    )


def _header(path: Path, index: int, mount_rpy_rad: MountRpy) -> FrameHeader:
    time_s = exif_time_s(path)
    time_s = float(index) if time_s is None else time_s
    try:
        tags = dji_tags(path)
        angles = [math.radians(float(tags[name])) for name in ANGLES]
    except (KeyError, ValueError):
        angles = [math.nan]
    if not all(abs(angle) <= MOST_ANGLE for angle in angles):  # nor NaN
        return FrameHeader(path.name, time_s)
    roll, pitch, yaw = angles
    return FrameHeader(
        path.name, time_s, up_in_camera(quaternion_from_rpy(roll, pitch, yaw), mount_rpy_rad), yaw
    )


def _own_camera(path: Path) -> Calibration:
    """A pinhole from the calibrated focal length in pixels (XMP), else from the 35 mm equivalent (EXIF)."""
    width, height = size_of(path)
    tags = dji_tags(path)
    try:
        focal = float(tags["CalibratedFocalLength"])
        centre = float(tags["CalibratedOpticalCenterX"]), float(tags["CalibratedOpticalCenterY"])
    except (KeyError, ValueError):
        focal, centre = focal_px(path, width, height) or 0.0, ((width - 1) / 2, (height - 1) / 2)
    if not (MAX_SIDE_PX**-1 < focal / max(width, height) < MAX_SIDE_PX and all(map(math.isfinite, centre))):
        raise InputError(path, "tells no focal length", "give the camera with --camera")
    return Calibration(Camera("pinhole", width, height, focal, focal, *centre))
