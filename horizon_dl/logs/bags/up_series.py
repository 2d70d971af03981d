"""The world's up over time in the frame of a sensor, whatever told it: orientations, an IMU, transforms."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.geometry.attitude import MAX_GAP_S, bracket, interpolate, rotation_from_quaternion, unit
from horizon_dl.logs.attitude_logs.inertial import around, ups_of_inertial
from horizon_dl.logs.bags.attitudes import PX4, Orientations
from horizon_dl.logs.bags.transforms import TransformTree

Floats = NDArray[np.float64]

LEAST_GRAVITY = 5.0
"""m/s^2 of the median force; less is no accelerometer's with gravity in it. Not picked on data."""
SILENT_WINDOW_S = 0.25
"""On each side of a moment; a hand or a drone turns little in it. Not picked on data."""


class UpSeries(Protocol):
    """Which way is up at a time.

    Attributes:
        topic: what told it.
        frame: in whose axes it is; empty where that is the robot's own body.
        frd: the body's axes are forward, right, down; else forward, left, up (REP 103).
        span_s: first and last time.
        note: what was done, in a sentence; or empty.
        late_s: from the headers' stamps to the arrivals, median; None where that is not known.
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

    @property
    def late_s(self) -> float | None: ...  # noqa: D102

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
    late_s: float | None = None

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
    late_s: float | None = None

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
    note = f"the world of {found.topic} has z down"
    down = found.up_world[2] < 0 and found.kind not in PX4
    return Turned(
        found.topic,
        found.frame,
        times,
        quaternions,
        found.up_world,
        found.z_down,
        note if down else "",
        _late_s(found, arrivals),
    )


def imu_series(found: Orientations, arrivals: bool = False) -> Felt | None:
    """By an IMU's gyroscope and accelerometer; None where it gives none, or gravity was taken out of them."""
    if found.rates is None or found.forces is None:
        return None
    both = np.hstack([found.rates, found.forces])
    times, felt = by_time(found.arrivals_s if arrivals else found.stamps_s, both, MOST_INERTIAL)
    if len(times) < 2 or float(np.median(np.linalg.norm(felt[:, 3:], axis=1))) < LEAST_GRAVITY:
        return None
    rates, forces = felt[:, :3], felt[:, 3:]
    silent = not rates.any()
    # Without rates a force is only that of its moment, with them it is carried over from other moments.
    ups = around(times, forces, SILENT_WINDOW_S) if silent else ups_of_inertial(times, rates, forces)
    down = bool(forces.mean(axis=0)[2] < -LEAST_GRAVITY)
    note = f"{found.topic} gives no orientation: it is estimated from its rates and forces"
    note += "; its gyroscope is silent" * silent
    note += "; its z points down: taken as forward, right, down" * down
    ups = ups / np.maximum(np.linalg.norm(ups, axis=1, keepdims=True), 1e-9)
    return Felt(found.topic, found.frame, times, ups, down, note, _late_s(found, arrivals))


def joined_imu(one: Orientations, other: Orientations, tree: TransformTree) -> Orientations | None:
    """A gyroscope and an accelerometer that publish apart, as one IMU at the gyroscope's times; else None.

    Their frames are the same, or joined by a tf that never turns. Where one of them is silent for long the
    other says nothing either.
    """
    for gyro, accelerometer in ((one, other), (other, one)):
        if gyro.rates is None or gyro.forces is None or accelerometer.forces is None:
            continue
        if not gyro.rates.any() or np.any(gyro.forces) or np.any(accelerometer.rates):
            continue
        way = _constant_turn(tree, gyro.frame, accelerometer.frame)
        stamped = [bool((found.stamps_s == found.arrivals_s).all()) for found in (gyro, accelerometer)]
        at_s, forces = by_time(accelerometer.stamps_s, accelerometer.forces, MOST_INERTIAL)
        if way is None or stamped[0] != stamped[1] or len(at_s) < 2:
            continue
        after = np.clip(np.searchsorted(at_s, gyro.stamps_s), 1, len(at_s) - 1)
        kept = (gyro.stamps_s >= at_s[0]) & (gyro.stamps_s <= at_s[-1])
        kept &= at_s[after] - at_s[after - 1] <= MAX_GAP_S
        felt = np.stack([np.interp(gyro.stamps_s[kept], at_s, axis) for axis in (forces @ way.T).T], axis=-1)
        return replace(
            gyro,
            topic=f"{gyro.topic} and {accelerometer.topic}",
            arrivals_s=gyro.arrivals_s[kept],
            stamps_s=gyro.stamps_s[kept],
            quaternions=gyro.quaternions[kept],
            rates=gyro.rates[kept],
            forces=felt,
        )
    return None


def _constant_turn(tree: TransformTree, target: str, source: str) -> Floats | None:
    if target == source:
        return np.eye(3)
    joined = bool(target and source) and tree.connected(target, source) and tree.constant(target, source)
    return tree.rotation(target, source, 0.0) if joined else None


def _late_s(found: Orientations, arrivals: bool) -> float | None:
    """None where the stamps are the arrivals."""
    late = found.arrivals_s - found.stamps_s
    return float(np.median(late)) if len(late) and not arrivals and late.any() else None
