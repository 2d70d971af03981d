"""The serial line of the onboard loop, on pseudo-terminals: garbage, hang-ups, and its return."""

import os
import threading
import time
import tty
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common

from horizon_dl.vehicle import transport
from horizon_dl.vehicle.mavlink import Link
from horizon_dl.vehicle.transport import Serial, open_transport


class Device:
    """A device file whose cable can be pulled: a link to the newest pseudo-terminal."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.controller = -1
        self.plug()

    def plug(self) -> None:
        self.controller, line = os.openpty()
        tty.setraw(line)
        os.set_blocking(self.controller, False)
        self.path.symlink_to(os.ttyname(line))
        self._line = line

    def pull(self) -> None:
        self.path.unlink()
        os.close(self._line)
        os.close(self.controller)
        self.controller = -1

    def sent(self) -> bytes:
        try:
            return os.read(self.controller, 100_000)
        except BlockingIOError:
            return b""


@pytest.fixture
def device(tmp_path: Path) -> Iterator[Device]:
    found = Device(tmp_path / "ttyAUTOPILOT")
    yield found
    if found.controller >= 0:
        found.pull()


def attitude(time_ms: int) -> bytes:
    message = common.MAVLink_attitude_quaternion_message(time_ms, 1, 0, 0, 0, 0, 0, 0)
    return bytes(message.pack(common.MAVLink(None, srcSystem=1, srcComponent=1)))


def next_time_ms(link: Link, timeout_s: float) -> int | None:
    """Of the first attitude that comes."""
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        for message in link.receive(0.05):
            return int(message.time_boot_ms)
    return None


def test_messages_pass_both_ways(device: Device) -> None:
    link = Link(open_transport(f"serial:{device.path}:115200"))
    os.write(device.controller, attitude(1000))
    assert next_time_ms(link, 2.0) == 1000
    assert link.send_heartbeat()
    sent = common.MAVLink(None).parse_buffer(device.sent())
    assert [message.get_type() for message in sent] == ["HEARTBEAT"]
    link.close()


def test_random_bytes_do_not_stop_it(device: Device) -> None:
    link = Link(open_transport(f"serial:{device.path}"))
    rng = np.random.default_rng(0)
    for _ in range(20):
        os.write(device.controller, rng.bytes(500))
        link.receive(0.05)
    # Bytes that look like a message's head may still wait for its rest: up to 280.
    for time_ms in range(1000, 1020):
        os.write(device.controller, attitude(time_ms))
    assert next_time_ms(link, 2.0) is not None
    assert link.counts["garbage"] > 10
    link.close()


def test_a_line_that_hangs_up_is_opened_again(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transport, "REOPEN_S", 0.1)
    link = Link(open_transport(f"serial:{device.path}"))
    os.write(device.controller, attitude(1000))
    assert next_time_ms(link, 2.0) == 1000
    device.pull()
    assert next_time_ms(link, 0.5) is None
    assert not link.send_heartbeat()
    device.plug()
    assert next_time_ms(link, 0.5) is None  # nothing has been sent, but it is listened to
    os.write(device.controller, attitude(2000))
    assert next_time_ms(link, 2.0) == 2000
    assert link.send_heartbeat()
    assert b"\xfd" in device.sent()
    link.close()


def test_it_is_not_tried_all_the_time_and_never_after_its_end(
    device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = Serial(str(device.path), 115200)
    device.pull()
    tried: list[float] = []

    def refuse() -> None:
        tried.append(time.monotonic())
        raise OSError("no such device")

    monkeypatch.setattr(transport, "REOPEN_S", 0.1)
    monkeypatch.setattr(line, "_open", refuse)
    end_s = time.monotonic() + 0.6
    while time.monotonic() < end_s:
        assert line.receive(0.01) == (b"", None)
    assert 2 <= len(tried) <= 6
    line.close()
    time.sleep(0.15)
    count = len(tried)
    assert line.receive(0.01) == (b"", None)
    assert not line.send(b"too late")
    assert len(tried) == count


def test_a_hang_up_while_another_thread_sends(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transport, "REOPEN_S", 0.02)
    line = Serial(str(device.path), 115200)
    stopped, raised = threading.Event(), []

    def send() -> None:
        try:
            while not stopped.is_set():
                line.send(bytes(50))
                time.sleep(0.001)
        except Exception as error:  # what is looked for
            raised.append(error)

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    for _ in range(4):
        device.pull()
        for _ in range(5):
            line.receive(0.02)
        device.plug()
        for _ in range(5):
            line.receive(0.02)
            device.sent()
    stopped.set()
    sender.join(2)
    assert not sender.is_alive()
    assert not raised
    assert line.send(b"still there")
    line.close()
