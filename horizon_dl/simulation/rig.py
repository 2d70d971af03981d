"""The simulated camera: its lens, how it is mounted, and how high it is carried."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Rig:
    """A pinhole camera on a vehicle or in a hand.

    Attributes:
        field_of_view_deg: horizontal.
        mount_pitch_deg: pitch of the camera in the body, positive up.
        height_m: lowest and highest place of the camera over the floor.
    """

    field_of_view_deg: float
    mount_pitch_deg: float
    height_m: tuple[float, float]

    @property
    def mount_rpy_deg(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw of the camera in the body."""
        return (0.0, self.mount_pitch_deg, 0.0)

    def focal_length_px(self, width: int) -> float:
        """Focal length in pixels of a picture of this width.

        Example:
            >>> Rig(90.0, 0.0, (1.0, 2.0)).focal_length_px(320)
            160.0
        """
        return round(float(width / 2 / np.tan(np.deg2rad(self.field_of_view_deg) / 2)), 6)


DRONE = Rig(field_of_view_deg=75.0, mount_pitch_deg=-9.0, height_m=(0.6, 2.5))


def draw_rig(rng: np.random.Generator) -> Rig:
    """Another lens, another mount, carried by a robot, a hand or a drone."""
    low, high = ((0.35, 0.6), (1.3, 1.7), (0.7, 2.2))[rng.integers(3)]
    return Rig(
        field_of_view_deg=round(float(rng.uniform(55, 105)), 1),
        mount_pitch_deg=round(float(rng.uniform(-18, 2)), 1),
        height_m=(low, high),
    )
