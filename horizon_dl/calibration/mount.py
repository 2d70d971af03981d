"""How a camera file's rotation to its IMU becomes the mount in the body.

The files do not state the IMU's axes. FLU and FRD, the two usual ones, differ by half a turn: taken for one
another, above becomes below. So the axes are stated, or asked for, and never assumed.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.candidate import Found
from horizon_dl.calibration.fields import Fields
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rpy_from_rotation
from horizon_dl.geometry.axes import ALL_AXES, axes_in_words, frd_from_axes

Mount = tuple[float, float, float]
KEY = "imu_axes"
USUAL = ("flu", "frd")


class AxesNotStatedError(InputError):
    """A file leads to an IMU and does not say which way its axes point."""


def rotation_of_axes(axes: str, where: str | Path = "--imu-axes") -> NDArray[np.float64]:
    """Rotation (3, 3) from an IMU with the named axes, as `flu`, to the body (FRD).

    Raises:
        InputError: no axes have this name; the error names the file or option where it stands.
    """
    try:
        return frd_from_axes(axes)
    except ValueError as error:
        hint = "give flu, frd or one of " + ", ".join(ALL_AXES[:6])
        raise InputError(where, f"{KEY} '{axes[:20]}': {error}", hint) from None


@dataclass(frozen=True)
class ImuMount:
    """A camera's place in an IMU whose axes the file does not state.

    Attributes:
        path: the file.
        field: that leads to the IMU.
        imu_from_camera: rotation from the optical frame to the IMU's axes, its nine numbers in rows.
    """

    path: Path
    field: str
    imu_from_camera: tuple[float, ...]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """`imu_from_camera` (3, 3)."""
        return np.array(self.imu_from_camera).reshape(3, 3)

    def rpy(self, axes: str) -> Mount:
        """Roll, pitch, yaw (rad) of the camera in the body (FRD) if the IMU has the named axes, as `flu`.

        Raises:
            InputError: no axes have this name.
        """
        return rpy_from_rotation(rotation_of_axes(axes, self.path) @ self.matrix @ OPTICAL_FROM_FRD)

    def question(self) -> AxesNotStatedError:
        """What to ask where the axes are needed."""
        says = []
        for name in USUAL:
            roll, pitch, _ = (math.degrees(angle) for angle in self.rpy(name))
            stands = "upright" if abs(roll) < 45 else "upside down" if abs(roll) > 135 else "on its side"
            looks = "ahead" if abs(pitch) < 3 else f"{abs(pitch):.0f} degrees {'up' if pitch > 0 else 'down'}"
            says.append(
                f"'{KEY}: {name}' ({axes_in_words(name)}; the camera then stands {stands}, looks {looks})"
            )
        return AxesNotStatedError(
            self.path,
            f"field '{self.field}' leads to an IMU whose axes it does not state",
            f"add the line {says[0]} or {says[1]} or another, or --imu-axes; calibrate-mount finds it",
        )


def mount_of(fields: Fields, found: Found, axes: str | None) -> Mount | ImuMount:
    """The camera in the body, or in the IMU where its axes are not stated; zero where the file has neither.

    Args:
        fields: of the whole file.
        found: the camera.
        axes: name of the IMU's axes, as `flu`, where they are stated.

    Raises:
        InputError: a field is wrong.
    """
    if fields.has("mount_rpy_deg"):
        roll, pitch, yaw = (math.radians(angle) for angle in fields.numbers("mount_rpy_deg", 3))
        return roll, pitch, yaw
    if found.imu_from_camera is None:
        return 0.0, 0.0, 0.0
    mount = ImuMount(fields.path, found.imu_field, tuple(found.imu_from_camera.ravel().tolist()))
    return mount if axes is None else mount.rpy(axes)
