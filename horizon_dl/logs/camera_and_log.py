"""A camera and the log of its attitude, in one body."""

from dataclasses import replace
from pathlib import Path

from horizon_dl.calibration.calibration import Calibration
from horizon_dl.calibration.mount import ImuMount
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD
from horizon_dl.logs.attitude_logs.registry import read_attitude


def check_camera(where: Path, calibration: Calibration | None, given: Given) -> None:
    """InputError where an attitude is given and no camera: it would be left out in silence."""
    if given.attitude is not None and calibration is None:
        raise InputError(where, "has an attitude, which needs to know the camera", "give --camera FILE")


def camera_and_log(
    calibration: Calibration, attitude: str, given: Given
) -> tuple[Calibration, AttitudeLog | ConstantAttitude]:
    """Reads what `--attitude` names; an IMU's samples are turned into the body by the axes that are stated.

    Where no axes are stated, and the camera's file leads to the IMU, its samples are turned into the camera:
    the body is the camera then, and heading and bearings are its own.

    Raises:
        InputError: see `read_attitude`; AxesNotStatedError where an IMU's axes have to be known.
    """
    stated = replace(given, imu_axes=calibration.imu_axes or given.imu_axes)
    if not isinstance(calibration.mount, ImuMount):
        return calibration, read_attitude(attitude, stated)
    log = read_attitude(attitude, stated, OPTICAL_FROM_FRD.T @ calibration.mount.matrix.T)
    if not isinstance(log, AttitudeLog) or not log.of_imu:
        return calibration, log
    names = f"{Path(attitude).name} is taken as the samples of the IMU that {calibration.mount.path.name}"
    taken = Doubt(
        f"{names} leads to; if it is of another one, state its axes (--imu-axes) and the camera's mount in "
        "the body (mount_rpy_deg)"
    )
    log = replace(log, notes=(*log.notes, taken))
    return replace(calibration, mount=None), log
