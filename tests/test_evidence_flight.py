"""Flights with a real net and a simulated autopilot: what shows nothing is unknown, and is said to be."""

import math
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import common
from small_run import model_file
from test_fly import Line, attitude, codec, decoded, rangefinder
from toy import toy_frame

from horizon_dl.data.frame import Frame
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.runtime.flight_loop import FlightLoop, FlightSettings
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.perception import Perception
from horizon_dl.vehicle.attitude_buffer import AttitudeBuffer, ClockOffset
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.obstacle_distance import UNKNOWN_CM

HEIGHT_M = 1.5
NO_MOUNT = (0.0, 0.0, 0.0)
Spoil = Callable[[np.ndarray, int], np.ndarray]


def pitch_at(step: int) -> float:
    return 0.08 * math.sin(step)


def frames(spoil: Spoil, count: int = 24, period_s: float = 0.05) -> Iterator[Frame]:
    """The toy world while the camera sways."""
    rng = np.random.default_rng(5)
    for step in range(count):
        time.sleep(period_s)
        pitch_rad = pitch_at(step)
        image = spoil(toy_frame(pitch_rad, rng)[0], step)
        up = up_in_camera(quaternion_from_rpy(0.0, pitch_rad, 0.0), NO_MOUNT)
        yield Frame(str(step), time.monotonic(), up, height_m=HEIGHT_M, image=image)


def flight(line: Line, **settings: Any) -> FlightLoop:
    perception = Perception.of(ObstacleModel.load(model_file()), NO_MOUNT, frames=1)
    return FlightLoop(perception, Link(line), FlightSettings(rate_hz=50, **settings))


def known_share(line: Line) -> float:
    """Of the messages, how many tell anything of any sector."""
    messages = decoded(line.sent)
    return float(np.mean([set(message.distances) != {UNKNOWN_CM} for message in messages]))


def texts(line: Line) -> str:
    return " | ".join(message.text for message in decoded(line.sent, "STATUSTEXT"))


def upside_down(image: np.ndarray, _: int) -> np.ndarray:
    return np.ascontiguousarray(image[::-1])


KEPT: dict[str, np.ndarray] = {}


def frozen(image: np.ndarray, step: int) -> np.ndarray:
    return KEPT.setdefault("image", image) if step else KEPT.update(image=image) or image


def noise(level: float, sd: float) -> Spoil:
    return lambda image, step: np.clip(
        np.random.default_rng(step).normal(level, sd, image.shape), 0, 255
    ).astype(np.uint8)


SPOILT: dict[str, tuple[Spoil, str]] = {
    "covered": (lambda image, _: np.zeros_like(image), "black"),
    "covered, noise": (noise(3, 2), "black"),
    "grey 128": (lambda image, _: np.full_like(image, 128), "no contrast"),
    "white-out": (lambda image, _: np.full_like(image, 255), "overexposed"),
    "noise": (noise(128, 40), "horizon"),
    "night": (lambda image, _: (image * 0.05).astype(np.uint8), "unfamiliar picture"),
    "fog": (lambda image, _: (image * 0.1 + 150).astype(np.uint8), "unfamiliar picture"),
    "upside down": (upside_down, "horizon"),
    "red lost": (lambda image, _: image * np.array([0, 1, 1], np.uint8), "a colour is lost"),
    "frozen": (frozen, "image frozen"),
}


def test_the_good_flight_tells_something() -> None:
    line = Line()
    fly = flight(line, recorded_attitude=True)
    fly.run(frames(lambda image, _: image))
    assert known_share(line) > 0.5
    evidence = fly.summary()["evidence"]
    assert evidence["frames"]["believed"] > 0.8 * fly.looked_at
    assert evidence["sectors"]["believed"] > 0


@pytest.mark.parametrize("name", SPOILT)
def test_what_shows_nothing_is_unknown_and_the_reason_is_said(name: str) -> None:
    spoil, reason = SPOILT[name]
    line = Line()
    fly = flight(line, recorded_attitude=True)
    fly.run(frames(spoil))
    evidence = fly.summary()["evidence"]
    # A frozen picture is seen with the second one; until then it was a good one.
    assert known_share(line) <= (0.15 if name == "frozen" else 0.0)
    assert evidence["frames"].get("believed", 0) <= (1 if name == "frozen" else 0)
    assert any(reason in why for why in evidence["frames"])
    assert "Obstacles unknown: " in texts(line)
    assert any(why in texts(line) for why in evidence["frames"])
    assert evidence["doubted_messages"] > 5


def test_half_a_picture_lost_takes_only_its_sectors_back() -> None:
    def left_half(image: np.ndarray, _: int) -> np.ndarray:
        return np.where(np.arange(image.shape[1])[None, :, None] < 40, image[40, 5], image).astype(np.uint8)

    line = Line()
    fly = flight(line, recorded_attitude=True)
    fly.run(frames(left_half))
    for message in decoded(line.sent):
        assert set(message.distances[66:71]) <= {UNKNOWN_CM}  # the left of the view


class Autopilot:
    """Sends what it is asked to until it is told to stop."""

    def __init__(self, line: Line, send: Callable[[int], list[bytes]], hz: float = 100.0) -> None:
        self._line, self._send, self._hz = line, send, hz
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Autopilot":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        step = 0
        while not self._stopped.wait(1 / self._hz):
            self._line.incoming += self._send(step)
            step += 1


def still_frames(count: int = 30, period_s: float = 0.05) -> Iterator[Frame]:
    """A camera that stands still and level, without attitude or height."""
    rng = np.random.default_rng(5)
    for step in range(count):
        time.sleep(period_s)
        yield Frame(str(step), time.monotonic(), image=toy_frame(0.0, rng)[0])


def flown(send: Callable[[int], list[bytes]], hz: float = 100.0, count: int = 30) -> tuple[FlightLoop, Line]:
    line = Line()
    fly = flight(line)
    with Autopilot(line, send, hz):
        fly.run(still_frames(count))
    return fly, line


def test_a_height_that_can_be_is_flown() -> None:
    mav = codec()
    fly, line = flown(lambda _: [attitude(mav, time.monotonic()), rangefinder(mav, HEIGHT_M)])
    assert known_share(line) > 0.4
    assert fly.summary()["evidence"]["frames"]["believed"] > 10


def test_an_attitude_that_never_changes_is_frozen() -> None:
    mav = codec()

    def same(step: int) -> list[bytes]:
        message = common.MAVLink_attitude_quaternion_message(int(time.monotonic() * 1e3), 1, 0, 0, 0, 0, 0, 0)
        return [bytes(message.pack(mav)), rangefinder(mav, HEIGHT_M)]

    fly, line = flown(same, count=65)
    messages = decoded(line.sent)
    assert any(set(message.distances) != {UNKNOWN_CM} for message in messages)  # not known to be frozen yet
    assert all(set(message.distances) == {UNKNOWN_CM} for message in messages[-5:])
    assert "attitude frozen" in texts(line)
    assert fly.summary()["evidence"]["frames"]["attitude frozen"] > 3


def test_for_how_long_an_attitude_stays() -> None:
    buffer = AttitudeBuffer()
    assert buffer.still_s == 0.0
    for step in range(30):
        buffer.add(step / 10, (1.0, 1e-7 * min(step, 5), 0.0, 0.0))
    assert buffer.still_s == pytest.approx(2.4)
    buffer.add(3.0, (1.0, 2e-7, 0.0, 0.0))
    assert buffer.still_s == 0.0


@pytest.mark.parametrize("height_m", [1000.0, 2147483.0])
def test_a_height_that_cannot_be_makes_all_unknown(height_m: float) -> None:
    mav = codec()
    high = common.MAVLink_local_position_ned_message(0, 0, 0, -height_m, 0, 0, 0)
    fly, line = flown(lambda _: [attitude(mav, time.monotonic()), bytes(high.pack(mav))])
    assert known_share(line) == 0.0
    assert "height cannot be" in texts(line)
    assert fly.summary()["evidence"]["frames"]["height cannot be"] > 5


def test_one_stamp_ahead_does_not_blind_the_flight() -> None:
    mav = codec()

    def send(step: int) -> list[bytes]:
        ahead_s = 0.9 if step == 20 else 0.0
        return [attitude(mav, time.monotonic() + ahead_s), rangefinder(mav, HEIGHT_M)]

    fly, line = flown(send, count=50)
    late = decoded(line.sent)[len(decoded(line.sent)) // 2 : -1]
    assert np.mean([set(message.distances) != {UNKNOWN_CM} for message in late]) > 0.6
    assert fly.without_attitude < 0.3 * fly.pictures_seen


def test_a_clock_that_was_set_ahead_is_followed_after_five_messages() -> None:
    clock = ClockOffset()
    for step in range(10):
        assert clock.to_ours(0.1 * step, 100 + 0.1 * step) == pytest.approx(100 + 0.1 * step)
    found = [clock.to_ours(0.1 * step + 5.0, 100 + 0.1 * step) for step in range(10, 20)]
    assert all(map(math.isnan, found[:4]))
    assert found[4:] == pytest.approx([100 + 0.1 * step for step in range(14, 20)])
    assert not AttitudeBuffer().add(math.nan, [1.0, 0.0, 0.0, 0.0])


def test_an_autopilot_of_another_id_is_named() -> None:
    from pymavlink.dialects.v20 import common

    other = codec(system=3)
    beat = common.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3)
    fly, line = flown(lambda _: [attitude(other, time.monotonic()), bytes(beat.pack(other))])
    assert known_share(line) == 0.0
    assert fly.summary()["other_autopilots"] == [3]
    assert "autopilot is system 3" in texts(line)


def test_attitudes_that_come_too_seldom_are_named() -> None:
    mav = codec()
    fly, line = flown(lambda _: [attitude(mav, time.monotonic()), rangefinder(mav, HEIGHT_M)], hz=4, count=40)
    assert "attitude 4 Hz, needs 10" in texts(line)
    assert fly.summary()["attitudes_hz"] == pytest.approx(4, abs=0.5)
