"""The attitude that transforms tell: a chain from a world down to the camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.logs.bags.transforms import TransformTree
from horizon_dl.logs.bags.up_series import up_and_heading

Floats = NDArray[np.float64]

WORLDS = ("map", "odom", "world", "earth", "mocap", "vicon", "optitrack", "global", "local_origin")
"""Roots whose z is up (REP 105); a tree that ends in the robot itself tells nothing of the world."""


@dataclass(frozen=True)
class Linked:
    """By the transforms from a world down to the camera's own frame."""

    tree: TransformTree
    frame: str
    topic: str = "/tf"
    frd: bool = False
    note: str = "the attitude is that of tf"

    @property
    def span_s(self) -> tuple[float, float]:
        """See `UpSeries`."""
        moving = [self.tree.links[name] for name in self.tree.chain(self.frame)[:-1]]
        times = [link.times_s for link in moving if not link.constant]
        return max(float(one[0]) for one in times), min(float(one[-1]) for one in times)

    def at(self, time_s: float, sensor_from_camera: Floats) -> tuple[Floats | None, float | None]:
        """See `UpSeries`."""
        turned = self.tree.rotation(self.tree.chain(self.frame)[-1], self.frame, time_s)
        if turned is None:
            return None, None
        return up_and_heading(turned @ sensor_from_camera, np.array([0.0, 0.0, 1.0]))


def transform_series(tree: TransformTree, camera_frame: str) -> Linked | None:
    """By transforms; None where the camera hangs on no world, or never moves in it."""
    chain = tree.chain(camera_frame)
    root = chain[-1].rsplit("/", 1)[-1].lower()
    moves = any(not tree.links[name].constant for name in chain[:-1] if name in tree.links)
    return Linked(tree, camera_frame) if moves and root.startswith(WORLDS) else None
