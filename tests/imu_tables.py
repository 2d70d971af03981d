"""Tables of an IMU's samples, made of attitudes; rotations by SciPy, gravity by hand."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from horizon_dl.geometry.axes import frd_from_axes

Floats = NDArray[np.float64]
HEADER = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2"


def imu_samples(times_s: Floats, ned_from_frd: Rotation, axes: str, rate_hz: float = 200.0) -> Floats:
    """(N, 7) time, rates (rad/s), specific forces (m/s^2) of an IMU with the named axes that only turns."""
    at_s = np.arange(times_s[0], times_s[-1], 1 / rate_hz)
    attitudes = Slerp(times_s, ned_from_frd)(at_s)
    frd_from_imu = frd_from_axes(axes)
    turns = (attitudes[:-1].inv() * attitudes[1:]).as_rotvec() * rate_hz
    rates = np.vstack([turns[:1], (turns[1:] + turns[:-1]) / 2, turns[-1:]])
    forces = attitudes.inv().apply([0.0, 0.0, -9.81])
    return np.column_stack([at_s, rates @ frd_from_imu, forces @ frd_from_imu])


def write_imu(path: Path, samples: Floats, header: str = HEADER, separator: str = ",") -> Path:
    """The table as a file."""
    rows = [separator.join(f"{value:.9g}" if k else f"{value:.6f}" for k, value in enumerate(row))
            for row in samples.tolist()]  # fmt: skip
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def flight(seconds: float = 40.0, swing: float = 1.0) -> tuple[Floats, Rotation]:
    """Times (s) and attitudes of a flight that turns about all axes, so much, and comes back."""
    times_s = np.arange(0.0, seconds, 0.05)
    roll, pitch = swing * 0.3 * np.sin(1.1 * times_s), -0.1 + swing * 0.25 * np.sin(0.7 * times_s)
    yaw = 0.8 * np.sin(0.4 * times_s)
    return times_s, Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll]))
