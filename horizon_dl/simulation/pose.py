"""Camera axes in the renderer's world from the drone's attitude.

Nothing of `geometry` is used: what the readers make of a simulated set is tested against what wrote it, and
the two must not share a mistake.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_WORLD_FROM_NED = np.diag((1.0, -1.0, -1.0))  # x north, y west, z up
_FRD_FROM_OPTICAL = np.array(((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))


def rotation_from_rpy(rpy_rad: Floats) -> Floats:
    """(3, 3) from (roll, pitch, yaw) in rad, aerospace order: `Rz(yaw) Ry(pitch) Rx(roll)`."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy_rad), np.sin(rpy_rad)
    return np.array(
        (
            (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr),
        )
    )


def optical_axes(rpy_rad: Floats, mount_rpy_rad: Floats) -> Floats:
    """Optical axes (right, down, forward) as columns in the world (x north, y west, z up).

    Args:
        rpy_rad: (3,) roll, pitch, yaw of the body (forward, right, down) in north-east-down.
        mount_rpy_rad: (3,) roll, pitch, yaw of the camera in the body.
    """
    ned = rotation_from_rpy(rpy_rad) @ rotation_from_rpy(mount_rpy_rad)
    axes: Floats = _WORLD_FROM_NED @ ned @ _FRD_FROM_OPTICAL
    return axes


def nudge(axes: Floats, shift_px: tuple[float, float], focal_px: float) -> Floats:
    """Axes turned so that the picture moves by less than a pixel (right, down)."""
    right, down, forward = axes.T
    turned = forward - (shift_px[0] * right + shift_px[1] * down) / focal_px
    turned /= np.linalg.norm(turned)
    side = np.cross(down, turned)
    side /= np.linalg.norm(side)
    return np.stack((side, np.cross(turned, side), turned), axis=1)
