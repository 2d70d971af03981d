"""Link and loop against MAVSDK, a C++ stack in process, as the autopilot; on loopback."""

import json
import math
import threading
import time
from collections.abc import Iterator
from typing import Any

import mavsdk
import numpy as np
import pytest
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkMessage
from numpy.typing import NDArray
from test_fly import CAMERA, HEIGHT_M, LEVEL, MOUNT, WALL_M, WallModel, wait_for

from horizon_dl.data.frame import Frame
from horizon_dl.geometry.attitude import quaternion_from_rpy
from horizon_dl.runtime.flight_loop import FlightLoop, FlightSettings
from horizon_dl.runtime.perception import Perception
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.obstacle_distance import UNKNOWN_CM, MessageShape, distances_cm
from horizon_dl.vehicle.telemetry import Autopilot
from horizon_dl.vehicle.transport import UdpIn

pytestmark = pytest.mark.usefixtures("trusting")


class Recorded(Link):
    """A link that keeps what the loop gave it to send."""

    def __init__(self, transport: UdpIn) -> None:
        super().__init__(transport)
        self.given: list[tuple[int, list[int]]] = []

    def send_distances(self, time_s: float, cm: Any, shape: Any) -> bool:
        has_left = super().send_distances(time_s, cm, shape)
        if has_left:
            self.given.append((int(time_s * 1e6), cm.tolist()))
        return has_left


def pictures() -> Iterator[Frame]:
    while True:
        time.sleep(0.03)
        yield Frame("a", time.monotonic(), image=np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8))


def stack_for(transport: UdpIn) -> mavsdk.Mavsdk:
    """The stack as an autopilot, connected to a listening port."""
    stack = mavsdk.Mavsdk(mavsdk.Configuration.create_manual(1, 1, True))
    address = f"udpout://127.0.0.1:{transport.address[1]}"
    assert stack.add_any_connection(address) == mavsdk.ConnectionResult.SUCCESS
    return stack


def subscribed(stack: mavsdk.Mavsdk) -> tuple[MavlinkDirect, list[dict[str, Any]]]:
    """Once the stack knows us: what it sends by, and the OBSTACLE_DISTANCE messages that it receives."""
    wait_for(lambda: bool(stack.get_systems()), 5.0)
    direct = MavlinkDirect(stack.get_systems()[0])
    received: list[dict[str, Any]] = []
    direct.subscribe_message(
        "OBSTACLE_DISTANCE", lambda message, _: received.append(json.loads(message.fields_json))
    )
    return direct, received


def send(direct: MavlinkDirect, name: str, **fields: float) -> None:
    direct.send_message(MavlinkMessage(name, 1, 1, 0, 0, json.dumps(fields)))


def send_attitude(direct: MavlinkDirect, time_ms: int, quaternion: NDArray[np.float64]) -> None:
    q1, q2, q3, q4 = quaternion.tolist()
    rates = {"rollspeed": 0.0, "pitchspeed": 0.0, "yawspeed": 0.0}
    send(direct, "ATTITUDE_QUATERNION", time_boot_ms=time_ms, q1=q1, q2=q2, q3=q3, q4=q4, **rates)


def send_pose(direct: MavlinkDirect) -> None:
    """A level attitude and the height of a range finder, as an autopilot sends them."""
    now_ms = int(time.monotonic() * 1e3)
    send_attitude(direct, now_ms, LEVEL)
    limits = {"min_distance": 10, "max_distance": 4000, "current_distance": int(HEIGHT_M * 100)}
    kind = {"type": 0, "id": 0, "orientation": 25, "covariance": 0}
    send(direct, "DISTANCE_SENSOR", time_boot_ms=now_ms, **limits, **kind)


def test_mavsdk_as_the_autopilot_sends_attitude_and_reads_the_distances() -> None:
    """Every value that leaves by the link is compared with what the stack received."""
    transport = UdpIn("127.0.0.1", 0)
    stack, link = stack_for(transport), Link(transport)
    wait_for(lambda: bool(link.receive(0.05)), 5.0)  # its heartbeat
    link.send_heartbeat()
    direct, received = subscribed(stack)
    q = quaternion_from_rpy(0.1, -0.2, 0.3)
    send_attitude(direct, 1234, q)
    autopilot = Autopilot()

    def attitude_came() -> bool:
        for message in link.receive(0.05):
            autopilot.take(message, time.monotonic())
        return autopilot.buffer.newest_s > -math.inf

    wait_for(attitude_came, 5.0)
    np.testing.assert_allclose(autopilot.buffer.at(autopilot.buffer.newest_s), q, atol=1e-6)
    shape = MessageShape()
    cm = distances_cm(None, shape)
    cm[:10] = np.arange(20, 1020, 100)
    cm[71] = shape.clear_cm
    assert link.send_distances(12.5, cm, shape)
    wait_for(lambda: bool(received), 5.0)
    got = received[0]
    assert got["distances"] == cm.tolist()
    assert (got["increment_f"], got["angle_offset"], got["frame"]) == (5.0, 0.0, 12)
    assert (got["min_distance"], got["max_distance"], got["time_usec"]) == (20, 1001 - 1, 12_500_000)
    stack.destroy()
    link.close()


def test_mavsdk_reads_what_the_loop_computed_from_its_attitude_and_height() -> None:
    transport = UdpIn("127.0.0.1", 0)
    stack, link = stack_for(transport), Recorded(transport)
    model = WallModel()
    flying = FlightLoop(Perception.of(model, MOUNT), link, FlightSettings(rate_hz=20, mount_rpy_rad=MOUNT))
    runner = threading.Thread(target=flying.run, args=(pictures(),), daemon=True)
    runner.start()
    direct, received = subscribed(stack)  # the loop answers its heartbeat
    end_s = time.monotonic() + 2.0
    while time.monotonic() < end_s:
        send_pose(direct)
        time.sleep(0.02)
    wait_for(lambda: flying.message_cm().min() == UNKNOWN_CM)  # no attitude any more
    flying.stop()
    runner.join(5)
    assert not runner.is_alive()
    wait_for(lambda: received[-1]["time_usec"] == link.given[-1][0])
    stack.destroy()
    link.close()
    # It listens some messages after the first; from then on it has every one, as it was computed.
    assert len(received) > 30
    got = [(message["time_usec"], message["distances"]) for message in received]
    assert got == link.given[-len(got) :]
    for message in received:
        assert (message["increment_f"], message["angle_offset"], message["frame"]) == (5.0, 0.0, 12)
        assert (message["min_distance"], message["max_distance"]) == (20, 1000)
    walls = [cm for _, cm in got if cm[0] != UNKNOWN_CM]
    assert len(walls) > 15
    ahead = np.array(walls)[:, [70, 71, 0, 1, 2]]
    np.testing.assert_allclose(ahead, WALL_M * 100, rtol=0.08)
    assert set(got[-1][1]) == {UNKNOWN_CM}
    assert flying.autopilot.heartbeats > 0
    assert flying.autopilot.buffer.height_at(end_s) == pytest.approx(HEIGHT_M, abs=0.02)
