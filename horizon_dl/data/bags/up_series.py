"""The world's up over time in the frame of a sensor, whatever told it: orientations, an IMU, transforms."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.bags.attitudes import PX4, Orientations
from horizon_dl.data.bags.transforms import TransformTree
from horizon_dl.data.imu import estimate_up
from horizon_dl.data.readers.parsing import MAX_GAP_S, by_time
from horizon_dl.geometry.attitude import bracket, interpolate, rotation_from_quaternion, unit

Floats = NDArray[np.float64]

WORLDS = ("map", "odom", "world", "earth", "mocap", "vicon", "optitrack", "global", "local_origin")
"""Roots whose z is up (REP 105); a tree that ends in the robot itself tells nothing of the world."""


class UpSeries(Protocol):
    """Which way is up at a time.

    Attributes:
        topic: what told it.
        frame: in whose axes it is; empty where that is the robot's own body.
        frd: the body's axes are forward, right, down; else forward, left, up (REP 103).
        span_s: first and last time.
        note: what was done, in a sentence; or empty.
    """

    @property
    def topic(self) -> str: ...  # noqa: D102

    @property
    def frame(self) -> str: ...  # noqa: D102

    @property
    def frd(self) -> bool: ...  # noqa: D102

    @property
    def span_s(self) -> tuple[float, float]: ...  # noqa: D102

    @property
    def note(self) -> str: ...  # noqa: D102

    def at(self, time_s: float, sensor_from_camera: Floats) -> tuple[Floats | None, float | None]:
        """Up in the camera (3,) and its heading (rad, clockwise seen from above); None: not known."""


@dataclass(frozen=True)
class Turned:
    """By orientations (N, 4) w x y z, the frame to a world whose up is `up_world`."""

    topic: str
    frame: str
    times_s: Floats
    quaternions: Floats
    up_world: tuple[float, float, float]
    frd: bool = False
    note: str = ""

    @property
    def span_s(self) -> tuple[float, float]:
        """See `UpSeries`."""
        return float(self.times_s[0]), float(self.times_s[-1])

    def at(self, time_s: float, sensor_from_camera: Floats) -> tuple[Floats | None, float | None]:
        """See `UpSeries`."""
        turned = interpolate(self.times_s, self.quaternions, time_s, MAX_GAP_S)
        if turned is None:
            return None, None
        world_from_camera = rotation_from_quaternion(turned) @ sensor_from_camera
        return _up_and_heading(world_from_camera, np.array(self.up_world))


@dataclass(frozen=True)
class Felt:
    """By up directions (N, 3) in the frame, from an IMU's filter: no heading."""

    topic: str
    frame: str
    times_s: Floats
    ups: Floats
    frd: bool = False
    note: str = ""

    @property
    def span_s(self) -> tuple[float, float]:
        """See `UpSeries`."""
        return float(self.times_s[0]), float(self.times_s[-1])

    def at(self, time_s: float, sensor_from_camera: Floats) -> tuple[Floats | None, float | None]:
        """See `UpSeries`."""
        place = bracket(self.times_s, time_s, MAX_GAP_S)
        if place is None:
            return None, None
        index, fraction = place
        after = min(index + 1, len(self.ups) - 1)
        up = (1 - fraction) * self.ups[index] + fraction * self.ups[after]
        return (unit(sensor_from_camera.T @ up) if np.linalg.norm(up) > 0.5 else None), None


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
        return _up_and_heading(turned @ sensor_from_camera, np.array([0.0, 0.0, 1.0]))


def _up_and_heading(world_from_camera: Floats, up_world: Floats) -> tuple[Floats, float]:
    ahead = world_from_camera[:, 2]
    heading = float(np.arctan2(ahead[1], ahead[0]))
    return unit(world_from_camera.T @ up_world), -heading if up_world[2] > 0 else heading


def orientation_series(found: Orientations, arrivals: bool = False) -> Turned | None:
    """By a topic's orientations, at its stamps or the arrivals; None where it gives none."""
    times, quaternions = by_time(found.arrivals_s if arrivals else found.stamps_s, found.quaternions)
    if len(times) < 2:
        return None
    note = f"the world of {found.topic} has z down, by the force of gravity in it"
    is_px4 = found.kind in PX4
    down = found.up_world[2] < 0 and not is_px4
    return Turned(found.topic, found.frame, times, quaternions, found.up_world, is_px4, note if down else "")


def imu_series(found: Orientations, arrivals: bool = False) -> Felt | None:
    """By an IMU's gyroscope and accelerometer; None where it gives none."""
    if found.rates is None or found.forces is None:
        return None
    both = np.hstack([found.rates, found.forces])
    times, felt = by_time(found.arrivals_s if arrivals else found.stamps_s, both)
    if len(times) < 2 or not felt[:, 3:].any():
        return None
    silent = "; its gyroscope is silent" if not felt[:, :3].any() else ""
    note = f"{found.topic} gives no orientation: it is estimated from its rates and forces{silent}"
    return Felt(found.topic, found.frame, times, estimate_up(times, felt[:, :3], felt[:, 3:]), False, note)


def transform_series(tree: TransformTree, camera_frame: str) -> Linked | None:
    """By transforms; None where the camera hangs on no world, or never moves in it."""
    chain = tree.chain(camera_frame)
    root = chain[-1].rsplit("/", 1)[-1].lower()
    moves = any(not tree.links[name].constant for name in chain[:-1] if name in tree.links)
    return Linked(tree, camera_frame) if moves and root.startswith(WORLDS) else None


def renamed(series: Turned | Felt | Linked, frame: str) -> Turned | Felt | Linked:
    """The series, its frame named."""
    return replace(series, frame=frame)
