"""The attitude that transforms tell: a chain from a world down to the camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.logs.bags.frames import is_world, points_down
from horizon_dl.logs.bags.transforms import TransformTree
from horizon_dl.logs.bags.up_series import up_and_heading

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Linked:
    """By the transforms from a world down to the camera's own frame."""

    tree: TransformTree
    frame: str
    topic: str = "/tf"
    frd: bool = False
    note: str = "the attitude is that of tf"
    late_s: float | None = None

    @property
    def span_s(self) -> tuple[float, float]:
        """See `UpSeries`."""
        moving = [self.tree.links[name] for name in self.tree.chain(self.frame)[:-1]]
        times = [link.times_s for link in moving if not link.constant]
        return max(float(one[0]) for one in times), min(float(one[-1]) for one in times)

    def at(self, time_s: float, sensor_from_camera: Floats) -> tuple[Floats | None, float | None]:
        """See `UpSeries`."""
        root = self.tree.chain(self.frame)[-1]
        turned = self.tree.rotation(root, self.frame, time_s)
        if turned is None:
            return None, None
        up = -1.0 if points_down(root) else 1.0
        return up_and_heading(turned @ sensor_from_camera, np.array([0.0, 0.0, up]))


def transform_series(tree: TransformTree, camera_frame: str) -> Linked | None:
    """By transforms; None where the camera hangs on no world, or never moves in it.

    A tree that ends in the robot itself tells nothing of the world.
    """
    chain = tree.chain(camera_frame)
    moves = any(not tree.links[name].constant for name in chain[:-1] if name in tree.links)
    return Linked(tree, camera_frame) if moves and is_world(chain[-1]) else None
