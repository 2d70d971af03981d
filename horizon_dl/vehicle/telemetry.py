"""What the autopilot's messages tell: attitude, height, and that it lives."""

import math
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.attitude import quaternion_from_rpy, rotation_from_quaternion
from horizon_dl.vehicle.attitude_buffer import MAX_HEIGHT_AGE_S, AttitudeBuffer, ClockOffset
from horizon_dl.vehicle.mavlink import Link

HEARTBEAT_S = 1.0
ATTITUDE_WAIT_S = 0.05
"""A picture waits so long for the attitude that follows it."""

DOWNWARD = 25  # MAV_SENSOR_ROTATION_PITCH_270
INVALID_SIGNAL = 1  # of DISTANCE_SENSOR.signal_quality, in percent; 0 is "not known"
HEIGHT_SOURCES = ("DISTANCE_SENSOR", "GLOBAL_POSITION_INT", "LOCAL_POSITION_NED")  # the best first


class Autopilot:
    """Keeps what is needed of an autopilot's messages.

    Args:
        clock: monotonic seconds.
        on_attitude: called for every good attitude.

    Attributes:
        buffer: attitudes and heights, by our clock.
        heartbeats: counted.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, on_attitude: Callable[[], object] = lambda: None
    ) -> None:
        self.buffer = AttitudeBuffer()
        self.heartbeats = 0
        self._now_s = clock
        self._on_attitude = on_attitude
        self._clock = ClockOffset()
        self._height_s = dict.fromkeys(HEIGHT_SOURCES, -math.inf)
        self._has_quaternions_s = -math.inf

    def listen(self, link: Link, stopped: threading.Event) -> None:
        """Take a link's messages, with a heartbeat once a second, until told to stop."""
        heartbeat_s = -math.inf
        while not stopped.is_set():
            if self._now_s() - heartbeat_s >= HEARTBEAT_S:
                link.send_heartbeat()
                heartbeat_s = self._now_s()
            for message in link.receive(0.1):
                self.take(message, self._now_s())

    def attitude_at(self, time_s: float, stopped: threading.Event) -> NDArray[np.float64] | None:
        """The attitude at a picture's time, (w, x, y, z), interpolated; None where it is not known.

        The next message is waited for shortly, then the newest one is taken. Another thread must `listen`.
        """
        end_s = self._now_s() + ATTITUDE_WAIT_S
        while self.buffer.newest_s < time_s and self._now_s() < end_s and not stopped.is_set():
            time.sleep(0.002)
        return self.buffer.at(time_s, max_ahead_s=ATTITUDE_WAIT_S)

    def take(self, message: Any, arrival_s: float) -> None:
        """Take one message, pymavlink's object; those of no use and with impossible values are left."""
        kind = message.get_type()
        if kind == "HEARTBEAT":
            self.heartbeats += 1
        elif kind == "ATTITUDE_QUATERNION":
            self._has_quaternions_s = arrival_s
            q = (message.q1, message.q2, message.q3, message.q4)
            self._attitude(q, message.time_boot_ms, arrival_s)
        elif kind == "ATTITUDE" and arrival_s - self._has_quaternions_s > 1.0:
            angles = (message.roll, message.pitch, message.yaw)
            if all(map(math.isfinite, angles)):
                self._attitude(quaternion_from_rpy(*angles), message.time_boot_ms, arrival_s)
        elif kind in HEIGHT_SOURCES:
            self._height(kind, message, arrival_s)

    def _attitude(self, quaternion: Any, time_boot_ms: int, arrival_s: float) -> None:
        time_s = self._clock.to_ours(time_boot_ms * 1e-3, arrival_s)
        if time_s < self.buffer.newest_s - 1.0:
            self.buffer.clear()
        if self.buffer.add(time_s, quaternion):
            self._on_attitude()

    def _height(self, kind: str, message: Any, arrival_s: float) -> None:
        better = HEIGHT_SOURCES[: HEIGHT_SOURCES.index(kind)]
        height_m = height_of(kind, message)
        if height_m is None or any(arrival_s - self._height_s[one] <= MAX_HEIGHT_AGE_S for one in better):
            return
        self._height_s[kind] = arrival_s
        if kind == "DISTANCE_SENSOR":
            height_m *= self._upright(arrival_s)
        self.buffer.add_height(arrival_s, height_m)

    def _upright(self, time_s: float) -> float:
        """Cosine of the body's tilt: a range finder fixed to it measures along its own axis."""
        attitude = self.buffer.at(time_s, max_ahead_s=MAX_HEIGHT_AGE_S)
        return 1.0 if attitude is None else float(rotation_from_quaternion(attitude)[2, 2])


def height_of(kind: str, message: Any) -> float | None:
    """Metres over the floor that a message gives, None for none.

    A range finder looks along the body's down axis and counts only within its own limits; the other two are
    heights over the place of the start, which is the floor's only if that is level.
    """
    if kind == "DISTANCE_SENSOR":
        within = message.min_distance < message.current_distance < message.max_distance
        valid = within and message.signal_quality != INVALID_SIGNAL
        return message.current_distance / 100 if message.orientation == DOWNWARD and valid else None
    height_m = message.relative_alt / 1000 if kind == "GLOBAL_POSITION_INT" else -message.z
    return float(height_m) if math.isfinite(height_m) and height_m > 0 else None
