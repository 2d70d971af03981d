"""MAVLink's signing time: what a flight sends is accepted by receivers that started at any time."""

import time
from types import SimpleNamespace
from typing import Any

import pytest
from test_fly import KEY, Line, attitude, codec

from horizon_dl.vehicle import mavlink
from horizon_dl.vehicle.mavlink import Link

MINUTE = 60 * 100_000
"""In the steps of a time stamp, 10 us."""


def receiver(later: int = 0) -> Any:
    """A receiver that has just started, with a clock that much ahead of the true time."""
    found = codec(key=KEY)
    found.robust_parsing = True
    found.signing.timestamp += later
    return found


def kinds(parser: Any, content: bytes) -> list[str]:
    return [message.get_type() for message in parser.parse_buffer(content)]


def at(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    monkeypatch.setattr(mavlink, "time", SimpleNamespace(time=lambda: seconds))  # not that of the receivers


def test_a_receiver_that_starts_two_minutes_later_accepts(monkeypatch: pytest.MonkeyPatch) -> None:
    line, now = Line(), time.time()
    at(monkeypatch, now)
    link = Link(line, key=KEY)
    link.send_heartbeat()
    late = receiver(2 * MINUTE)
    assert kinds(late, line.sent[-1]) == ["BAD_DATA"]  # such a message is too old for it
    at(monkeypatch, now + 120)
    link.send_heartbeat()
    assert kinds(late, line.sent[-1]) == ["HEARTBEAT"]


@pytest.mark.parametrize("clock_s", [100.0, 1.4e9])
def test_a_clock_that_was_never_set_learns_the_time_of_its_peer(
    clock_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    line, peer = Line(), codec(key=KEY)
    at(monkeypatch, clock_s)
    link = Link(line, key=KEY)
    assert link.send_heartbeat()  # before 2015
    line.incoming = [attitude(peer, 1.0)]
    assert len(link.receive(0.0)) == 1
    link.send_heartbeat()
    assert kinds(receiver(), line.sent[-1]) == ["HEARTBEAT"]


def test_a_clock_an_hour_behind_learns_the_time_of_its_peer(monkeypatch: pytest.MonkeyPatch) -> None:
    line, peer = Line(), codec(key=KEY)
    at(monkeypatch, time.time() - 3600)
    link = Link(line, key=KEY)
    line.incoming = [attitude(peer, 1.0)]
    link.receive(0.0)
    link.send_heartbeat()
    assert kinds(receiver(), line.sent[-1]) == ["HEARTBEAT"]


def test_a_forged_stamp_teaches_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    line, forger = Line(), codec(key=bytes(32))
    now = time.time()
    at(monkeypatch, now)
    link = Link(line, key=KEY)
    forger.signing.timestamp += 60 * MINUTE
    line.incoming = [attitude(forger, 1.0)]
    assert link.receive(0.0) == []
    link.send_heartbeat()
    stamp = int.from_bytes(line.sent[-1][-12:-6], "little")
    assert stamp == pytest.approx((now - 1420070400) * 1e5, abs=100)


def test_stamps_grow_even_if_the_clock_is_set_back(monkeypatch: pytest.MonkeyPatch) -> None:
    line, parser, now = Line(), receiver(), time.time()
    at(monkeypatch, now)
    link = Link(line, key=KEY)
    for seconds in (0, 0, 5, -3600, -3600):
        at(monkeypatch, now + seconds)
        link.send_heartbeat()
    assert [kinds(parser, content) for content in line.sent] == [["HEARTBEAT"]] * 5
