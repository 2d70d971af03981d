"""The real loop with MAVSDK, a C++ stack in process, as the autopilot; on loopback."""

import json
import threading
import time
from collections.abc import Iterator
from typing import Any

import mavsdk
import numpy as np
import pytest
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkMessage
from test_fly import CAMERA, HEIGHT_M, LEVEL, MOUNT, WALL_M, WallModel, wait_for

from horizon_dl.onboard.fly import Fly, FlySettings
from horizon_dl.onboard.mavlink import Link
from horizon_dl.onboard.obstacle_distance import UNKNOWN_CM
from horizon_dl.onboard.pictures import Picture
from horizon_dl.onboard.sighting import Sighting
from horizon_dl.onboard.transport import UdpIn


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


def pictures() -> Iterator[Picture]:
    while True:
        time.sleep(0.03)
        yield Picture(time.monotonic(), np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8))


def fields(**values: float) -> str:
    return json.dumps(values)


def send_pose(direct: MavlinkDirect) -> None:
    """A level attitude and the height of a range finder, as an autopilot sends them."""
    now_ms = int(time.monotonic() * 1e3)
    w, x, y, z = LEVEL.tolist()
    rates = {"rollspeed": 0.0, "pitchspeed": 0.0, "yawspeed": 0.0}
    attitude = fields(time_boot_ms=now_ms, q1=w, q2=x, q3=y, q4=z, **rates)
    limits = {"min_distance": 10, "max_distance": 4000, "current_distance": int(HEIGHT_M * 100)}
    kind = {"type": 0, "id": 0, "orientation": 25, "covariance": 0}
    height = fields(time_boot_ms=now_ms, **limits, **kind)
    direct.send_message(MavlinkMessage("ATTITUDE_QUATERNION", 1, 1, 0, 0, attitude))
    direct.send_message(MavlinkMessage("DISTANCE_SENSOR", 1, 1, 0, 0, height))


def test_mavsdk_reads_what_the_loop_computed_from_its_attitude_and_height() -> None:
    transport = UdpIn("127.0.0.1", 0)
    stack = mavsdk.Mavsdk(mavsdk.Configuration.create_manual(1, 1, True))
    port = transport.address[1]
    assert stack.add_any_connection(f"udpout://127.0.0.1:{port}") == mavsdk.ConnectionResult.SUCCESS
    link = Recorded(transport)
    model = WallModel()
    flying = Fly(Sighting.of(model, MOUNT), link, FlySettings(rate_hz=20, mount_rpy_rad=MOUNT))
    runner = threading.Thread(target=flying.run, args=(pictures(),), daemon=True)
    runner.start()
    wait_for(lambda: bool(stack.get_systems()), 5.0)  # the loop answers its heartbeat
    direct = MavlinkDirect(stack.get_systems()[0])
    received: list[dict[str, Any]] = []
    direct.subscribe_message(
        "OBSTACLE_DISTANCE", lambda message, _: received.append(json.loads(message.fields_json))
    )
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
