"""Which axis of a trajectory's world points up: z as it should, or y as graphics have it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.attitude import rotation_from_quaternion

Floats = NDArray[np.float64]

Z = np.array([0.0, 0.0, 1.0])
Y = np.array([0.0, 1.0, 0.0])
NEARLY_ALL, HARDLY_ANY = 0.8, 0.1
UPRIGHT = np.cos(np.deg2rad(60.0))
TURNS = np.cos(np.deg2rad(45.0))
LEVEL_M = 0.5

Y_UP = "the world's y axis is taken as up: with z up the camera would hardly ever be upright"
FIRST_CAMERA = (
    "the trajectory starts in its first camera, which is taken as level: look at check-data's overlays"
)
Y_DOWN = "with the world's z axis up the camera is hardly ever upright; with its y axis down it would be"
NOT_UPRIGHT = "with the world's z axis up the camera is hardly ever upright; with its y axis up it would be"


@dataclass(frozen=True)
class World:
    """A trajectory's world.

    Attributes:
        up: (3,) its up.
        camera_y_up: the camera's axes are right, up, forward (left-handed) and not right, down, forward.
        note: what was found, or nothing.
    """

    up: Floats = field(default_factory=lambda: Z)
    camera_y_up: bool = False
    note: str = ""

    def optical(self, vector: Floats) -> Floats:
        """A vector (3,) in the camera's axes, in those of the optical frame."""
        return vector * [1.0, -1.0, 1.0] if self.camera_y_up else vector

    def yaw(self, forward: Floats) -> float:
        """Heading (rad), clockwise seen from above, of a direction (3,) in the world."""
        if self.up is Z:
            return -float(np.arctan2(forward[1], forward[0]))
        right_handed = bool(self.up[1] > 0) and not self.camera_y_up
        return float(np.arctan2(forward[0], -forward[2] if right_handed else forward[2]))


Z_UP = World()


def find_world(poses: Floats, *, certain: bool) -> World:
    """The world of a trajectory.

    With z up unless then the camera is hardly ever upright, and with y up it nearly always is. A camera that
    looks down and flies north gives the same rotations, so more has to speak for y: the format, or a path
    that is level that way, or a camera that turns about y.

    Args:
        poses: (N, 7) tx ty tz qx qy qz qw.
        certain: the format is one whose world has y up.
    """
    step = max(1, len(poses) // 500)
    rotations = np.array([rotation_from_quaternion(q) for q in poses[::step, [6, 3, 4, 5]]])
    z_cam, y_cam = (rotations.transpose(0, 2, 1) @ axis for axis in (Z, Y))
    if (-z_cam[:, 1] > UPRIGHT).mean() > HARDLY_ANY:
        return Z_UP
    if (-y_cam[:, 1] > UPRIGHT).mean() >= NEARLY_ALL:
        sure = certain or _level_along_y(poses) or _turns_about_y(rotations)
        return World(Y, note=Y_UP) if sure else World(note=NOT_UPRIGHT)
    if (y_cam[:, 1] > UPRIGHT).mean() < NEARLY_ALL:
        return Z_UP
    if np.allclose(poses[0, :3], 0.0, atol=1e-6) and y_cam[0, 1] > 1 - 1e-6:
        return World(-Y, note=FIRST_CAMERA)
    if certain:  # ICL-NUIM: its camera's axes are left-handed, and roll and pitch have other signs than above
        return World(Y, camera_y_up=True, note=f"{Y_UP}; the camera's y axis, too, points up")
    return World(note=Y_DOWN)


def _turns_about_y(rotations: Floats) -> bool:
    """Whether the optical axis points in directions over 45 degrees apart, seen along y."""
    level = rotations[:, [0, 2], 2]
    level = level / np.maximum(np.linalg.norm(level, axis=-1, keepdims=True), 1e-9)
    return bool((level @ level[0]).min() < TURNS)


def _level_along_y(poses: Floats) -> bool:
    """Whether the path moves much along x and z, and little along y."""
    x, y, z = np.ptp(poses[:, :3], axis=0).tolist()
    return bool(y < LEVEL_M and y < 0.3 * min(x, z))
