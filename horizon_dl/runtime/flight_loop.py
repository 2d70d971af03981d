"""The onboard loop: pictures in, obstacle distances out, on a fixed timer, with a watchdog.

Four threads: pictures, the autopilot's messages, the model (the caller's), and the timer that sends. The
timer sends in any case; whenever the watchdog is not content it sends "unknown".
"""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError
from horizon_dl.evidence.plausible import HeightWatch
from horizon_dl.evidence.reason import Reason
from horizon_dl.geometry.attitude import up_in_camera, yaw_of
from horizon_dl.ranging.sectors import FreeDistances
from horizon_dl.runtime.latency import Latencies
from horizon_dl.runtime.perception import Perception
from horizon_dl.runtime.watchdog import Clock, Watchdog
from horizon_dl.sources.newest import NewestFrame
from horizon_dl.vehicle.flight_params import FlightParams
from horizon_dl.vehicle.mavlink import INFO, WARNING, Link
from horizon_dl.vehicle.obstacle_distance import MessageShape, distances_cm
from horizon_dl.vehicle.telemetry import Autopilot

LEAST_ATTITUDES_HZ = 8.0


@dataclass(frozen=True)
class FlightSettings:
    """How the loop runs.

    Attributes:
        rate_hz: of OBSTACLE_DISTANCE.
        shape: of the message.
        mount_rpy_rad: of the camera in the body.
        recorded_attitude: take attitude and height from the pictures, not from the autopilot.
        height_m: fixed height of the camera, or None.
        params: of the watchdog.
    """

    rate_hz: float = 20.0
    shape: MessageShape = field(default_factory=MessageShape)
    mount_rpy_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    recorded_attitude: bool = False
    height_m: float | None = None
    params: FlightParams = field(default_factory=FlightParams)


@dataclass(frozen=True)
class _Sighted:
    time_s: float
    found: FreeDistances | None
    doubted: bool = False


class FlightLoop:
    """One flight.

    Attributes:
        watchdog: of this flight.
        autopilot: what its messages told.
        latencies: from the picture's time to its first message.
        periods: between messages.
        sent: messages that have left; `unsent` could not.
        unknown: messages that said "unknown" because of the watchdog.
        doubted: messages that said "unknown" because the newest frame showed no evidence.
        without_attitude: pictures for whose time there was none; an autopilot has to send 10 a second.
        on_look: told every frame that was looked at, with the sectors; it must not take long.
    """

    def __init__(
        self, perception: Perception, link: Link, settings: FlightSettings, clock: Clock = time.monotonic
    ) -> None:
        self.watchdog = Watchdog(clock, settings.params, hint=self._attitude_hint)
        self.autopilot = Autopilot(clock, self.watchdog.attitude)
        self.latencies, self.periods = Latencies(), Latencies()
        self.sent = self.unsent = self.unknown = self.looked_at = self.without_attitude = self.doubted = 0
        self.pictures_seen = self.pictures_skipped = 0
        self._perception, self._link, self._settings, self._clock = perception, link, settings, clock
        self._newest = _Sighted(-np.inf, None)
        self._height = HeightWatch(perception.model.rules.evidence)
        self._reported_s = -np.inf
        self.on_look: Callable[[Frame, FreeDistances], None] | None = None
        self._stop = threading.Event()
        self._error: Exception | None = None

    def run(
        self,
        frames: Iterator[Frame | FrameError] | Iterator[Frame],
        duration_s: float | None = None,
        stop_source: Callable[[], None] = lambda: None,
    ) -> None:
        """Fly until the frames end, the time is over, or `stop` is called; the last message is "unknown".

        Args:
            frames: as they come.
            duration_s: end after this time.
            stop_source: ends `frames` from another thread.

        Raises:
            Exception: whatever ended the frames, such as InputError for a camera that is not there.
        """
        slot = NewestFrame(frames, self.watchdog.camera, stop_source)
        threads = [
            threading.Thread(target=self._guarded, args=(target,), name=name, daemon=True)
            for target, name in ((self._listen, "autopilot"), (self._report, "timer"))
        ]
        end_s = np.inf if duration_s is None else self._clock() + duration_s
        for thread in threads:
            thread.start()
        slot.start()
        try:
            while not (self._stop.is_set() or self._clock() >= end_s):
                frame = slot.take(0.1)
                if frame is not None:
                    self.look(frame)
                elif slot.ended:
                    break
        finally:
            self._stop.set()
            listener, timer = threads
            timer.join(2.0)  # so that no distance follows the last word
            self._link.send_distances(
                self._clock(), distances_cm(None, self._settings.shape), self._settings.shape
            )
            self._link.send_text("Obstacles unknown: stopped", WARNING)
            listener.join(2.0)
            slot.stop()
        self.pictures_seen, self.pictures_skipped = slot.seen, slot.skipped
        error = self._error or slot.error
        if error is not None:
            raise error

    def stop(self) -> None:
        """End the flight soon; from any thread."""
        self._stop.set()

    def look(self, frame: Frame) -> None:
        """One frame to sectors; an error of the model is the watchdog's, not the loop's."""
        pose = self._pose(frame)
        if pose is None:
            self.without_attitude += 1
            self._newest = _Sighted(frame.time_s, None)
            return
        up_cam, yaw_rad, height_m = pose
        doubts: tuple[Reason, ...] = ()
        longest_s = self._perception.model.rules.evidence.attitude_still_s
        if not self._settings.recorded_attitude and self.autopilot.buffer.still_s > longest_s:
            doubts = (Reason.ATTITUDE_STILL,)
        if height_m is not None and not self._height.good(frame.time_s, height_m):
            doubts, height_m = (*doubts, Reason.HEIGHT), None
        floor = frame.floor_up_cam if self._settings.recorded_attitude else None
        try:
            found = self._perception.look(
                frame.time_s, frame.image, up_cam, yaw_rad, height_m, floor, doubts=doubts
            )
        except Exception as error:  # onnxruntime raises kinds of its own; flying on blind would be worse
            self.watchdog.model_failed(type(error).__name__)
            self._newest = _Sighted(frame.time_s, None)
            return
        self.looked_at += 1
        judged = self._perception.judged
        self._newest = _Sighted(frame.time_s, found, judged is not None and bool(judged.reasons))
        if judged is not None:
            few = self._settings.params.doubt_share * len(found.outcome)
            self.watchdog.doubt(
                judged.reasons or (why for why, count in judged.sectors.items() if count > few)
            )
        self.watchdog.result(frame.time_s)
        if self.on_look is not None:
            seen = replace(frame, up_cam=up_cam, height_m=height_m, floor_up_cam=floor, yaw_rad=yaw_rad)
            self.on_look(seen, found)

    def message_cm(self) -> NDArray[np.uint16]:
        """(72,) what is to be sent now."""
        newest = self._newest
        if self.watchdog.troubles():
            self.unknown += 1
            return distances_cm(None, self._settings.shape)
        self.doubted += newest.doubted
        return distances_cm(newest.found, self._settings.shape)

    def summary(self) -> dict[str, Any]:
        """Figures of the flight so far, ready for JSON."""
        return {
            "messages": {"sent": self.sent, "unsent": self.unsent, "unknown": self.unknown},
            "evidence": {**self._perception.judge.summary(), "doubted_messages": self.doubted},
            "latency": self.latencies.summary(),
            "period": self.periods.summary(),
            "pictures": {
                "seen": self.pictures_seen,
                "skipped": self.pictures_skipped,
                "looked_at": self.looked_at,
                "without_attitude": self.without_attitude,
            },
            "filter_delay_s": self._perception.filter.delay_s,
            "received": dict(self._link.counts),
            "heartbeats": self.autopilot.heartbeats,
            "attitudes_hz": self.autopilot.buffer.rate_hz,
            "other_autopilots": sorted(self._link.strangers),
        }

    def _pose(self, frame: Frame) -> tuple[NDArray[np.float64], float, float | None] | None:
        """`up_cam`, yaw and height at the picture's time; None where the attitude is not known."""
        fixed_m = self._settings.height_m
        if self._settings.recorded_attitude:
            if frame.up_cam is None:
                return None
            self.watchdog.attitude()
            return frame.up_cam, 0.0, frame.height_m if fixed_m is None else fixed_m
        attitude = self.autopilot.attitude_at(frame.time_s, self._stop)
        if attitude is None:
            return None
        yaw_rad = yaw_of(attitude)
        height_m = self.autopilot.buffer.height_at(frame.time_s) if fixed_m is None else fixed_m
        return up_in_camera(attitude, self._settings.mount_rpy_rad), yaw_rad, height_m

    def _attitude_hint(self) -> str:
        """What is known of why no attitude comes."""
        rate_hz = self.autopilot.buffer.rate_hz
        if rate_hz is not None and rate_hz < LEAST_ATTITUDES_HZ:
            return f"attitude {rate_hz:.0f} Hz, needs 10"
        if not self.autopilot.heartbeats and self._link.strangers:
            return f"autopilot is system {min(self._link.strangers)}"
        return ""

    def _guarded(self, target: Callable[[], None]) -> None:
        """A thread that dies must not go unnoticed: the flight ends and says why."""
        try:
            target()
        except Exception as error:  # whatever it was
            self._error = error
            self._stop.set()

    def _listen(self) -> None:
        self.autopilot.listen(self._link, self._stop)

    def _report(self) -> None:
        period_s = 1.0 / self._settings.rate_hz
        due_s = self._clock()
        last_s = -np.inf
        while not self._stop.is_set():
            now = self._clock()
            self._send(last_s)
            last_s = now
            due_s = max(due_s + period_s, now)
            self._stop.wait(max(0.0, due_s - self._clock()))

    def _send(self, last_s: float) -> None:
        newest, unknown = self._newest, self.unknown
        cm, now = self.message_cm(), self._clock()
        has_left = self._link.send_distances(newest.time_s if newest.found else now, cm, self._settings.shape)
        self.sent += has_left
        self.unsent += not has_left
        if np.isfinite(last_s):
            self.periods.add(now - last_s)
        if newest.found is not None and newest.time_s > self._reported_s and self.unknown == unknown:
            self.latencies.add(self._clock() - newest.time_s)
            self._reported_s = newest.time_s
        line = self.watchdog.to_say()
        if line is not None:
            good = not (self.watchdog.troubles() or self.watchdog.doubts())
            self._link.send_text(line, INFO if good else WARNING)
