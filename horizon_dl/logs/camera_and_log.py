"""A camera and the log of its attitude, in one body."""

from dataclasses import replace

from horizon_dl.calibration.calibration import Calibration
from horizon_dl.calibration.mount import ImuMount
from horizon_dl.data.attitude_log import AttitudeLog, ConstantAttitude
from horizon_dl.data.given import Given
from horizon_dl.logs.attitude_logs.registry import read_attitude


def camera_and_log(
    calibration: Calibration, attitude: str, given: Given
) -> tuple[Calibration, AttitudeLog | ConstantAttitude]:
    """Reads what `--attitude` names; an IMU's samples are turned into the body by the axes that are stated.

    A camera file that leads to the IMU itself needs no statement for these: whatever its axes are called,
    samples and mount are in the same ones.

    Raises:
        InputError: see `read_attitude`; AxesNotStatedError where an IMU's axes have to be known.
    """
    leads_to_imu = isinstance(calibration.mount, ImuMount)
    axes = calibration.imu_axes or ("frd" if leads_to_imu else None)
    log = read_attitude(attitude, replace(given, imu_axes=axes))
    if isinstance(calibration.mount, ImuMount) and isinstance(log, AttitudeLog) and log.of_imu:
        calibration = replace(calibration, mount=calibration.mount.rpy("frd"))
    return calibration, log
