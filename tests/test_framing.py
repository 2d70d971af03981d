"""Frames among any bytes: none is lost but those that are hit, whatever stands between them."""

import os
import random

os.environ["MAVLINK20"] = "1"
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common
from test_fly import KEY, Line, codec

from horizon_dl.vehicle.framing import MOST_TRIED
from horizon_dl.vehicle.mavlink import GARBAGE, Link


def level(mav, time_ms: int) -> bytes:
    return bytes(common.MAVLink_attitude_quaternion_message(time_ms, 1.0, 0, 0, 0, 0, 0, 0).pack(mav))


def heard(content: bytes, sizes: list[int], key: bytes | None = None) -> tuple[list[int], Link]:
    """The times of the messages that a stream gives, read in pieces; and the link."""
    line = Line()
    line.whole_messages = False
    link = Link(line, 1, key)
    found, place = [], 0
    while place < len(content):
        size = sizes[place % len(sizes)]
        line.incoming.append(content[place : place + size])
        found += [message.time_boot_ms for message in link.receive(0)]
        place += size
    return found, link


@settings(max_examples=60, deadline=None)
@given(
    noise=st.lists(st.one_of(st.binary(max_size=40), st.just(b"\xfd\xff\x00"), st.just(b"\xfe\xfe"))),
    sizes=st.lists(st.integers(1, 90), min_size=1, max_size=5),
)
def test_every_message_between_any_bytes_is_found(noise: list[bytes], sizes: list[int]) -> None:
    mav = codec()
    content = b"".join(part + level(mav, 20 * index) for index, part in enumerate(noise))
    content += b"".join(level(mav, 10_000 + 20 * n) for n in range(10))  # what makes a false beginning whole
    found, _ = heard(content, sizes)
    assert found == [20 * n for n in range(len(noise))] + [10_000 + 20 * n for n in range(10)]


def test_a_signing_time_that_looks_like_a_beginning_blinds_nobody(monkeypatch) -> None:
    """pymavlink's own parser lost all messages for minutes, once one of them was damaged."""
    stamp = 0xFD_FD_FD_FD_00 + 1000
    monkeypatch.setattr("horizon_dl.vehicle.mavlink._signing_stamp", lambda: stamp)
    mav = codec(key=KEY)
    mav.signing.timestamp = stamp
    messages = [level(mav, 20 * n) for n in range(100)]
    chance = random.Random(0)
    for index in range(0, 60, 7):
        messages[index] = messages[index][: chance.randrange(1, len(messages[index]))]
    found, _ = heard(b"".join(messages), [17, 60], KEY)
    assert found == [20 * n for n in range(100) if n >= 60 or n % 7]


@pytest.mark.parametrize("place", range(1, 14))
@pytest.mark.parametrize("sizes", [[71], [1], [30, 41]])
def test_a_forged_signature_that_looks_like_a_beginning_is_no_garbage(place: int, sizes: list[int]) -> None:
    mav = codec(key=KEY)
    forged = bytearray(level(mav, 0))
    forged[-13:] = bytes(13)
    forged[-place] = 0xFD
    found, link = heard(bytes(forged) + level(mav, 20) + level(mav, 40), sizes, KEY)
    assert found == [20, 40]
    assert link.counts == {"bad_signature": 1, "accepted": 2}


@pytest.mark.parametrize("marker", [0xFD, 0xFE])
@pytest.mark.parametrize("place", range(1, 14))
def test_nor_is_it_in_a_datagram_of_its_own(place: int, marker: int) -> None:
    mav = codec(key=KEY)
    forged = bytearray(level(mav, 0))
    forged[-13:] = bytes(13)
    forged[-place] = marker
    line = Line()
    line.incoming = [bytes(forged), level(mav, 20), b"\xfd\x1c", b"\x00" + level(mav, 40)]
    link = Link(line, 1, KEY)
    found = [message.time_boot_ms for _ in range(4) for message in link.receive(0)]
    assert found == [20, 40]
    assert link.counts == {"bad_signature": 1, "accepted": 2, "garbage": 2}  # what is none is counted still


def test_messages_of_other_dialects_are_passed_over_whole() -> None:
    mav = codec()
    unknown = bytearray(level(mav, 0))
    unknown[7:10] = (60_000).to_bytes(3, "little")
    unknown[15] = 0xFD  # in its payload
    content = level(mav, 20) + bytes(unknown) * 3 + level(mav, 40) + bytes(unknown) + b"\x00" + level(mav, 60)
    found, _ = heard(content, [1000])
    assert found == [20, 40, 60]


def test_a_datagram_of_beginnings_costs_little() -> None:
    line = Line()
    link = Link(line, 1, None)
    line.incoming = [b"\xfd\x40\x00" * 20_000, level(codec(), 20)]
    tried = 0
    decode = link._incoming.decode

    def counted(frame: bytearray):
        nonlocal tried
        tried += 1
        return decode(frame)

    link._incoming.decode = counted
    assert link.receive(0) == []
    assert tried <= MOST_TRIED
    assert link.counts[GARBAGE] == 1
    assert len(link.receive(0)) == 1
