"""The onboard loop: messages, links, hostile bytes, slow, fast and stalled cameras, on loopback only."""

import math
import os
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

os.environ["MAVLINK20"] = "1"
from flat_model import ANY_PLACE
from pymavlink.dialects.v20 import common

from horizon_dl.data.frame import Frame
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.polar import bearings_for
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.runtime.flight_loop import FlightLoop, FlightSettings
from horizon_dl.runtime.latency import Latencies
from horizon_dl.runtime.perception import Perception, forward_in_camera, model_rays
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.sources.newest import NewestFrame
from horizon_dl.vehicle.mavlink import Link, read_signing_key
from horizon_dl.vehicle.obstacle_distance import UNKNOWN_CM
from horizon_dl.vehicle.telemetry import Autopilot, height_of
from horizon_dl.vehicle.transport import UdpIn, UdpOut, open_transport

pytestmark = pytest.mark.usefixtures("trusting")

CAMERA = Camera("pinhole", 80, 60, 60.0, 60.0, 39.5, 29.5)
MOUNT = (0.0, math.radians(-15), 0.0)
LEVEL = quaternion_from_rpy(0.0, 0.0, 0.0)
WALL_M, HEIGHT_M = 3.0, 1.0
KEY = bytes(range(32))
LARGEST_GAP_S = 0.5
"""Between two messages sent 50 times a second, however busy the machine; autopilots bear 0.5 s."""


RECORDED = FlightSettings(rate_hz=50, mount_rpy_rad=MOUNT, recorded_attitude=True)


class WallModel:
    """A model that sees a round wall at 3 m, wherever the attitude says that it is."""

    camera = CAMERA
    threshold = 0.5
    place = ANY_PLACE
    rules = FlightRules()

    def __init__(self) -> None:
        self.fails = False
        self.takes_s = 0.0

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Any:
        time.sleep(self.takes_s)
        if self.fails:
            raise RuntimeError("no luck")
        assert image.shape == (60, 80, 3)
        assert up_cam is not None
        above = elevation(camera_rays(CAMERA).directions, up_cam)
        p_above = np.where(above > -math.atan(HEIGHT_M / WALL_M), 0.4, 0.03).astype(np.float32)
        return SimpleNamespace(p_above=p_above, elevation=above)


class Line:
    """A transport in memory."""

    whole_messages = True

    def __init__(self) -> None:
        self.incoming: list[bytes] = []
        self.sent: list[bytes] = []
        self.distances_at_s: list[float] = []

    def receive(self, timeout_s: float) -> tuple[bytes, None]:
        if not self.incoming:
            time.sleep(min(timeout_s, 0.002))
            return b"", None
        return self.incoming.pop(0), None

    def accept(self, peer: object) -> bool:
        return True

    def send(self, content: bytes) -> bool:
        self.sent.append(content)
        if is_distances(content):
            self.distances_at_s.append(time.monotonic())
        return True

    def close(self) -> None:
        pass


def is_distances(content: bytes) -> bool:
    """Whether it is OBSTACLE_DISTANCE of MAVLink 2, by the message's number in the header."""
    return int.from_bytes(content[7:10], "little") == common.MAVLINK_MSG_ID_OBSTACLE_DISTANCE


def codec(system: int = 1, component: int = 1, key: bytes | None = None) -> Any:
    mav = common.MAVLink(None, srcSystem=system, srcComponent=component)
    if key:
        mav.signing.secret_key, mav.signing.sign_outgoing = key, True
        mav.signing.timestamp = int((time.time() - 1420070400) * 1e5)
    return mav


def attitude(mav: Any, time_s: float, q: ArrayLike = LEVEL) -> bytes:
    w, x, y, z = np.asarray(q).tolist()
    x += 1e-6 * math.sin(100 * time_s)  # an IMU's noise
    return bytes(common.MAVLink_attitude_quaternion_message(int(time_s * 1e3), w, x, y, z, 0, 0, 0).pack(mav))


def rangefinder(mav: Any, metres: float, orientation: int = 25) -> bytes:
    message = common.MAVLink_distance_sensor_message(0, 10, 4000, int(metres * 100), 0, 0, orientation, 0)
    return bytes(message.pack(mav))


def decoded(sent: list[bytes], kind: str = "OBSTACLE_DISTANCE") -> list[Any]:
    parser = common.MAVLink(None)
    messages = [message for content in sent for message in parser.parse_buffer(content) or []]
    return [message for message in messages if message.get_type() == kind]


def pictures(count: int, period_s: float = 0.02) -> Iterator[Frame]:
    up = up_in_camera(LEVEL, MOUNT)
    for _ in range(count):
        time.sleep(period_s)
        yield Frame("a", time.monotonic(), up, height_m=HEIGHT_M, image=np.zeros((60, 80, 3), np.uint8))


def perception(model: WallModel | None = None) -> Perception:
    return Perception.of(model or WallModel(), MOUNT)


def test_rays_come_out_of_the_model_itself() -> None:
    rays, expected = model_rays(WallModel()), camera_rays(CAMERA).directions
    np.testing.assert_allclose(rays, expected, atol=2e-4)


def test_the_bodys_forward_axis_and_the_sectors_that_hold_the_view() -> None:
    np.testing.assert_allclose(forward_in_camera((0, 0, 0)), [0, 0, 1], atol=1e-12)
    # A camera that looks 90 degrees to the right has the body's forward axis on its left.
    np.testing.assert_allclose(forward_in_camera((0, 0, math.pi / 2)), [-1, 0, 0], atol=1e-12)
    bearings = bearings_for(model_rays(WallModel()), (0.0, 0.0, 1.0))
    assert bearings.count % 2 == 0
    half_view = math.atan(39.5 / 60)
    assert half_view <= bearings.count / 2 * bearings.step_rad < half_view + math.radians(1.5)


def test_a_recorded_flight_sends_the_wall(tmp_path: Path) -> None:
    line = Line()
    fly = FlightLoop(perception(), Link(line), RECORDED)
    fly.run(pictures(25))
    messages = decoded(line.sent)
    assert len(messages) >= 15
    first = messages[0]
    assert (first.frame, first.increment_f, first.angle_offset) == (12, 5.0, 0.0)
    assert (first.min_distance, first.max_distance, first.increment) == (20, 1000, 5)
    assert set(messages[0].distances) == {UNKNOWN_CM}  # nothing was known yet
    middle = messages[len(messages) // 2].distances
    np.testing.assert_allclose([middle[i] for i in (70, 71, 0, 1, 2)], WALL_M * 100, rtol=0.08)
    assert set(middle[8:65]) == {UNKNOWN_CM}
    assert set(messages[-1].distances) == {UNKNOWN_CM}
    texts = [message.text for message in decoded(line.sent, "STATUSTEXT")]
    assert texts[-1] == "Obstacles unknown: stopped"
    assert "Obstacles: recovered" in texts
    assert len(decoded(line.sent, "HEARTBEAT")) == 1
    summary = fly.summary()
    assert summary["messages"]["unsent"] == 0
    assert summary["latency"]["p99_ms"] < 400


@pytest.mark.parametrize("stalled", ["camera", "attitude", "model"])
def test_a_stall_is_unknown_within_half_a_second_and_recovers(stalled: str) -> None:
    line, model = Line(), WallModel()
    flying = FlightLoop(perception(model), Link(line), FlightSettings(rate_hz=50, mount_rpy_rad=MOUNT))
    broken = threading.Event()
    mav = codec()

    def feed() -> None:
        while not flying._stop.is_set():
            if not (broken.is_set() and stalled == "attitude"):
                line.incoming += [attitude(mav, time.monotonic()), rangefinder(mav, HEIGHT_M)]
            time.sleep(0.01)

    def see() -> Iterator[Frame]:
        for picture in pictures(1000):
            if flying._stop.is_set():
                return
            if not (broken.is_set() and stalled == "camera"):
                yield Frame("a", picture.time_s, image=picture.image)

    def known() -> bool:
        # The body is not tilted, so the range finder's height is the camera's.
        return is_known(decoded(line.sent[-10:])[-1])

    threading.Thread(target=feed, daemon=True).start()
    runner = threading.Thread(target=flying.run, args=(see(),), daemon=True)
    runner.start()
    wait_for(lambda: len(decoded(line.sent[-10:])) > 3 and known())
    since = len(line.sent)
    broken.set()
    model.fails = stalled == "model"
    wait_for(lambda: not known(), 1.0)
    unknown_since = len(line.sent)
    time.sleep(0.5)
    assert not known()
    in_the_stall = decoded(line.sent[unknown_since:])
    assert len(in_the_stall) > 5
    assert not any(is_known(message) for message in in_the_stall)
    broken.clear()
    model.fails = False
    wait_for(known)
    flying.stop()
    runner.join(3)
    texts = " | ".join(message.text for message in decoded(line.sent, "STATUSTEXT"))
    later = " | ".join(message.text for message in decoded(line.sent[since:], "STATUSTEXT"))
    said = {"model": "model failed: Runt", "camera": "camera stale", "attitude": "attitude stale"}
    assert said[stalled] in later  # before its first picture every flight says "stale"
    assert texts.count("recovered") >= 2


def is_known(message: Any) -> bool:
    """Whether any sector tells anything."""
    return set(message.distances) != {UNKNOWN_CM}


def test_messages_keep_their_rate_while_the_model_hangs() -> None:
    line, model = Line(), WallModel()
    fly = FlightLoop(perception(model), Link(line), RECORDED)
    runner = threading.Thread(target=fly.run, args=(pictures(1000), 2.5), daemon=True)
    runner.start()
    wait_for(lambda: any(map(is_known, decoded(line.sent[-10:]))))
    model.takes_s = 1.0
    time.sleep(0.6)  # a look at work, and what was known has become stale
    first = len(line.sent)
    time.sleep(0.3)
    hanging = decoded(line.sent[first:])
    model.takes_s = 0.0
    wait_for(lambda: is_known(decoded(line.sent[-10:])[-1]))
    runner.join(5)
    assert len(hanging) > 3
    assert not any(map(is_known, hanging))
    assert len(line.distances_at_s) > 50
    assert max(np.diff(line.distances_at_s)) < LARGEST_GAP_S


def wait_for(condition: Any, timeout_s: float = 3.0) -> None:
    end = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < end, "did not happen in time"
        time.sleep(0.005)


@pytest.mark.parametrize(("period_s", "takes_s"), [(0.002, 0.03), (0.15, 0.0)])
def test_fast_and_slow_cameras(period_s: float, takes_s: float) -> None:
    line, model = Line(), WallModel()
    model.takes_s = 0.0
    looking = perception(model)
    model.takes_s = takes_s
    fly = FlightLoop(looking, Link(line), RECORDED)
    fly.run(pictures(int(0.9 / period_s), period_s))
    messages = decoded(line.sent)[:-1]
    known = [m.distances[0] != UNKNOWN_CM for m in messages]
    assert sum(known) > 0.4 * len(known)
    # The view's sectors tell all together or not at all; behind the camera nothing is ever told.
    assert {sum(cm != UNKNOWN_CM for cm in m.distances) > 5 for m in messages if is_known(m)} == {True}
    assert {cm for m in messages for cm in m.distances[8:65]} == {UNKNOWN_CM}
    summary = fly.summary()
    if takes_s:
        assert summary["pictures"]["skipped"] > 0.5 * summary["pictures"]["seen"]  # the latest wins
        assert summary["latency"]["median_ms"] < 150
    else:
        assert summary["pictures"]["skipped"] == 0
    assert summary["period"]["median_ms"] == pytest.approx(20, abs=10)
    assert max(np.diff(line.distances_at_s)) < LARGEST_GAP_S


def test_without_height_obstacles_are_unknown_not_invented() -> None:
    line = Line()
    fly = FlightLoop(perception(), Link(line), RECORDED)
    no_height = (replace(frame, height_m=None) for frame in pictures(15))
    fly.run(no_height)
    assert fly.looked_at >= 10
    for message in decoded(line.sent):
        assert set(message.distances) == {UNKNOWN_CM}


def test_a_camera_that_breaks_ends_the_flight_with_unknown() -> None:
    line = Line()

    def broken() -> Iterator[Frame]:
        yield from pictures(3)
        raise InputError("camera:0", "is gone", "plug it in")

    fly = FlightLoop(perception(), Link(line), FlightSettings(rate_hz=50, recorded_attitude=True))
    with pytest.raises(InputError, match="is gone"):
        fly.run(broken())
    assert set(decoded(line.sent)[-1].distances) == {UNKNOWN_CM}


def test_a_line_that_fails_ends_the_flight_and_is_not_silent() -> None:
    line = Line()
    fly = FlightLoop(perception(), Link(line), FlightSettings(rate_hz=50, recorded_attitude=True))

    def fail(*_: object) -> None:
        raise OSError("bus error")

    fly.autopilot.take = fail  # type: ignore[method-assign]
    line.incoming = [attitude(codec(), 1.0)]
    with pytest.raises(OSError, match="bus error"):
        fly.run(pictures(200))
    assert decoded(line.sent, "STATUSTEXT")[-1].text == "Obstacles unknown: stopped"


def test_other_systems_are_ignored_and_counted() -> None:
    line = Line()
    link = Link(line, system=1)
    line.incoming = [
        attitude(codec(system=2), 1.0),
        attitude(codec(component=200), 1.0),
        attitude(codec(), 1.0),
    ]
    taken = [message for _ in range(3) for message in link.receive(0.0)]
    assert [message.get_srcSystem() for message in taken] == [1]
    assert link.counts == {"foreign_system": 2, "accepted": 1}


def test_signatures_are_asked_for() -> None:
    line = Line()
    link = Link(line, key=KEY)
    forged, good = codec(key=bytes(32)), codec(key=KEY)
    forged.signing.timestamp += 10**9  # from the future: must not shut out the true sender
    replayed = attitude(good, 1.0)
    line.incoming = [attitude(codec(), 1.0), attitude(forged, 1.0), replayed, replayed, attitude(good, 2.0)]
    taken = [message for _ in range(5) for message in link.receive(0.0)]
    assert [message.time_boot_ms for message in taken] == [1000, 2000]
    assert link.counts == {"bad_signature": 3, "accepted": 2}


def test_ours_are_signed() -> None:
    line = Line()
    assert Link(line, key=KEY).send_heartbeat()
    parser = codec(key=KEY)
    assert parser.parse_buffer(line.sent[0])[0].get_type() == "HEARTBEAT"
    stranger = codec(key=bytes(32))
    stranger.robust_parsing = True
    assert stranger.parse_buffer(line.sent[0])[0].get_type() == "BAD_DATA"


@settings(deadline=None, max_examples=150)
@given(st.lists(st.binary(min_size=1, max_size=300), max_size=6), st.integers(0, 40), st.integers(0, 255))
def test_garbage_never_stops_the_link(datagrams: list[bytes], place: int, value: int) -> None:
    line = Line()
    link = Link(line)
    bent = bytearray(attitude(codec(), 1.0))
    bent[place % len(bent)] = value
    line.incoming = [*datagrams, bytes(bent), b"\xfd\xff", attitude(codec(), 2.0)]
    taken = [message for _ in range(len(datagrams) + 3) for message in link.receive(0.0)]
    assert taken[-1].time_boot_ms == 2000


def test_garbage_in_a_running_flight() -> None:
    line = Line()
    rng = np.random.default_rng(0)
    line.incoming = [rng.bytes(int(rng.integers(1, 600))) for _ in range(2000)]
    line.incoming += [bytes([0xFD]) + rng.bytes(40) for _ in range(500)]
    fly = FlightLoop(perception(), Link(line), RECORDED)
    fly.run(pictures(30))
    assert not line.incoming
    assert any(message.distances[0] != UNKNOWN_CM for message in decoded(line.sent))
    assert sum(fly._link.counts.values()) > 2000


def test_texts_are_cut_to_what_fits() -> None:
    line = Line()
    assert Link(line).send_text("é" * 80)
    assert decoded(line.sent, "STATUSTEXT")[0].text == "?" * 50


def test_attitude_and_height_of_messages() -> None:
    autopilot = Autopilot()
    roll = quaternion_from_rpy(math.radians(60), 0.0, 0.0)
    q = SimpleNamespace(
        get_type=lambda: "ATTITUDE_QUATERNION",
        time_boot_ms=1000,
        q1=roll[0],
        q2=roll[1],
        q3=roll[2],
        q4=roll[3],
    )
    autopilot.take(q, 50.0)
    np.testing.assert_allclose(autopilot.buffer.at(50.0), roll)
    finder = SimpleNamespace(
        get_type=lambda: "DISTANCE_SENSOR",
        orientation=25,
        current_distance=200,
        min_distance=10,
        max_distance=900,
        signal_quality=0,
    )
    autopilot.take(finder, 50.1)
    assert autopilot.buffer.height_at(50.1) == pytest.approx(1.0)  # 2 m along an axis tilted by 60 degrees
    above_home = SimpleNamespace(get_type=lambda: "GLOBAL_POSITION_INT", relative_alt=7000)
    autopilot.take(above_home, 50.2)
    assert autopilot.buffer.height_at(50.2) == pytest.approx(1.0)  # the range finder is better
    autopilot.take(above_home, 52.0)
    assert autopilot.buffer.height_at(52.0) == pytest.approx(7.0)


def test_attitude_in_angles_is_the_same_attitude() -> None:
    autopilot = Autopilot()
    angles = SimpleNamespace(get_type=lambda: "ATTITUDE", time_boot_ms=10, roll=0.1, pitch=-0.2, yaw=3.0)
    autopilot.take(angles, 5.0)
    np.testing.assert_allclose(autopilot.buffer.at(5.0), quaternion_from_rpy(0.1, -0.2, 3.0))
    nothing = SimpleNamespace(get_type=lambda: "ATTITUDE", time_boot_ms=20, roll=math.nan, pitch=0, yaw=0)
    autopilot.take(nothing, 5.1)
    assert autopilot.buffer.newest_s == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("orientation", "cm", "quality", "expected"),
    [
        (25, 150, 0, 1.5),  # 0: the quality is not known
        (25, 150, 100, 1.5),
        (25, 150, 2, 1.5),
        (25, 150, 1, None),  # 1: the signal is invalid
        (0, 150, 0, None),
        (25, 5, 0, None),
    ],
)
def test_only_a_range_finder_that_looks_down_and_sees_counts(
    orientation: int, cm: int, quality: int, expected: float | None
) -> None:
    sent = common.MAVLink_distance_sensor_message(
        0, 10, 900, cm, 0, 0, orientation, 0, signal_quality=quality
    )
    message = codec().parse_buffer(sent.pack(codec()))[0]
    assert height_of("DISTANCE_SENSOR", message) == expected


def test_udp_listens_on_the_given_address_only_and_keeps_its_peer() -> None:
    transport = UdpIn("127.0.0.1", 0)
    assert transport.address[0] == "127.0.0.1"
    link = Link(transport)
    assert not link.send_heartbeat()  # nobody there yet
    friend, stranger = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    for one in (friend, stranger):
        one.bind(("127.0.0.1", 0))
        one.settimeout(1.0)
    stranger.sendto(b"garbage", transport.address)
    friend.sendto(attitude(codec(), 1.0), transport.address)
    stranger.sendto(attitude(codec(), 2.0), transport.address)
    taken = [message for _ in range(3) for message in link.receive(1.0)]
    assert [message.time_boot_ms for message in taken] == [1000]
    assert link.counts["foreign_system"] == 1
    assert link.send_heartbeat()
    assert decoded([friend.recv(500)], "HEARTBEAT")
    stranger.settimeout(0.05)
    with pytest.raises(TimeoutError):
        stranger.recv(500)
    for one in (friend, stranger, transport):
        one.close()


def test_udpout_survives_that_nobody_is_there() -> None:
    free = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
    free.close()
    link = Link(UdpOut("127.0.0.1", port))
    for _ in range(5):
        link.send_heartbeat()
        assert link.receive(0.02) == []
    link.close()


@pytest.mark.parametrize(
    "url", ["", "udp:1.2.3.4:5", "udpout:host", "udpin::5", "tcp:a:1", "udpout:127.0.0.1:99999"]
)
def test_wrong_addresses_are_one_line(url: str) -> None:
    with pytest.raises(InputError, match="udpout:HOST:PORT"):
        open_transport(url)


def test_a_taken_port_is_one_line() -> None:
    first = UdpIn("127.0.0.1", 0)
    with pytest.raises(InputError, match="cannot be opened"):
        open_transport(f"udpin:127.0.0.1:{first.address[1]}")
    first.close()


def test_signing_keys(tmp_path: Path) -> None:
    import hashlib

    path = tmp_path / "key"
    path.write_bytes(KEY)
    assert read_signing_key(path) == KEY
    path.write_text(KEY.hex() + "\n")
    assert read_signing_key(path) == KEY
    path.write_text("open sesame\n")
    assert read_signing_key(path) == hashlib.sha256(b"open sesame").digest()
    path.write_text("\n")
    with pytest.raises(InputError, match="is empty"):
        read_signing_key(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_signing_key(tmp_path / "none")


def test_the_latest_picture_wins() -> None:
    slot = NewestFrame(pictures(5, 0.001), lambda: None)
    slot.start()
    wait_for(lambda: slot.ended)
    last = slot.take(0.0)
    assert last is not None
    assert (slot.seen, slot.skipped) == (5, 4)
    assert slot.take(0.0) is None


def test_latencies_against_sorting() -> None:
    values = np.random.default_rng(0).gamma(2.0, 0.02, 3000)
    latencies = Latencies()
    for value in values.tolist():
        latencies.add(value)
    for percentile in (1, 50, 99):
        assert latencies.percentile_ms(percentile) == pytest.approx(
            1e3 * np.percentile(values, percentile), abs=1.1
        )
    assert Latencies().percentile_ms(50) is None
