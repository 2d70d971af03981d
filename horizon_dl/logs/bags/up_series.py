"""The world's up over time in the frame of a sensor, whatever told it: orientations, an IMU, transforms."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.imu import estimate_up
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.geometry.attitude import MAX_GAP_S, bracket, interpolate, rotation_from_quaternion, unit
from horizon_dl.logs.bags.attitudes import PX4, Orientations

Floats = NDArray[np.float64]


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
        return up_and_heading(world_from_camera, np.array(self.up_world))

    def as_read(self, time_s: float) -> tuple[float, ...] | None:
        """The quaternion w x y z at a time."""
        turned = interpolate(self.times_s, self.quaternions, time_s, MAX_GAP_S)
        return None if turned is None else tuple(turned.tolist())


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


def up_and_heading(world_from_camera: Floats, up_world: Floats) -> tuple[Floats, float]:
    """Up in the camera (3,), and its heading (rad, clockwise seen from above)."""
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
    times, felt = by_time(found.arrivals_s if arrivals else found.stamps_s, both, MOST_INERTIAL)
    if len(times) < 2 or not felt[:, 3:].any():
        return None
    silent = "; its gyroscope is silent" if not felt[:, :3].any() else ""
    note = f"{found.topic} gives no orientation: it is estimated from its rates and forces{silent}"
    return Felt(found.topic, found.frame, times, estimate_up(times, felt[:, :3], felt[:, 3:]), False, note)
