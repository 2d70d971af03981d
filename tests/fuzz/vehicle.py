"""MAVLink streams: bytes that were damaged, and whole messages with values that cannot be."""

import os
import random
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fuzz.kind import Case
from fuzz.mutations import damaged
from horizon_dl.vehicle.mavlink import Link, _signing_stamp
from horizon_dl.vehicle.telemetry import Autopilot

KEY = bytes(range(32))
GOOD_AFTER = 40
"""Whole messages within which a stream that was damaged is understood again."""
FLOATS = (0.0, -0.0, 1.0, -1.0, 1e-30, 1e30, -1e30, 3e38, float("nan"), float("inf"), -float("inf"), 0.7071)
INTEGERS = (0, 1, 2, 25, 100, 127, 128, 255, 65535, 2**31 - 1, 2**32 - 1)


class Bytes:
    """A line that gives what it was told to."""

    def __init__(self, parts: list[bytes], whole_messages: bool) -> None:
        self.parts, self.whole_messages = parts, whole_messages

    def receive(self, timeout_s: float) -> tuple[bytes, None]:
        return (self.parts.pop(0) if self.parts else b""), None

    def accept(self, peer: object) -> bool:
        return True

    def send(self, content: bytes) -> bool:
        return True

    def close(self) -> None:
        pass


def mavlink(_: Path) -> Case:
    """A second of an autopilot's messages, signed or not, as datagrams or as one stream."""
    os.environ["MAVLINK20"] = "1"
    from pymavlink.dialects.v20 import common

    def case(chance: random.Random) -> None:
        key = KEY if chance.random() < 0.3 else None
        codec = common.MAVLink(None, srcSystem=1, srcComponent=1)
        if key:
            codec.signing.secret_key, codec.signing.sign_outgoing = key, True
            codec.signing.timestamp = _signing_stamp()
        packets = [bytes(message.pack(codec)) for message in _messages(common, chance)]
        datagrams = chance.random() < 0.5
        for _ in range(chance.choice((0, 1, 2, 5))):
            at = chance.randrange(len(packets))
            packets[at] = damaged(packets[at], chance)
        if not datagrams:
            stream = b"".join(packets)
            stream = damaged(stream, chance) if chance.random() < 0.5 else stream
            edges = sorted(chance.randrange(len(stream) + 1) for _ in range(20))
            packets = [stream[a:b] for a, b in zip([0, *edges], [*edges, len(stream)], strict=True)]
        good = [bytes(_level(common, 60_000 + 20 * n).pack(codec)) for n in range(GOOD_AFTER)]
        link = Link(Bytes([*packets, *good], datagrams), 1, key)
        _listen(link, len(packets), GOOD_AFTER)

    return case


def _listen(link: Link, damaged_parts: int, good: int) -> None:
    """What is kept is a rotation and a height, whatever has come; and good messages are taken again."""
    autopilot, arrival_s = Autopilot(clock=lambda: 100.0), 100.0
    for index in range(damaged_parts + good):
        arrival_s += 0.02
        for message in link.receive(0.0):
            autopilot.take(message, arrival_s)
        if index % 7 == 0:
            attitude, height_m = autopilot.buffer.at(arrival_s, 0.15), autopilot.buffer.height_at(arrival_s)
            assert attitude is None or abs(np.linalg.norm(attitude) - 1) < 1e-6
            assert height_m is None or 0 < height_m < float("inf")
    assert autopilot.buffer.at(arrival_s, 0.15) is not None, "blind after the damage"
    assert all(len(str(name)) < 100 for name in link.counts)


def _level(common: Any, time_boot_ms: int) -> Any:
    return common.MAVLink_attitude_quaternion_message(time_boot_ms, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def _messages(common: Any, chance: random.Random) -> Iterator[Any]:
    """Twenty messages; some of their fields hold any value that their type can."""
    kinds = [
        common.MAVLink_heartbeat_message,
        common.MAVLink_attitude_message,
        common.MAVLink_attitude_quaternion_message,
        common.MAVLink_distance_sensor_message,
        common.MAVLink_global_position_int_message,
        common.MAVLink_local_position_ned_message,
        common.MAVLink_statustext_message,
    ]
    for index in range(20):
        if chance.random() < 0.4:
            yield _level(common, 1000 + 20 * index)
            continue
        kind = chance.choice(kinds)
        content = bytearray(struct.calcsize(kind.unpacker.format))
        layout = kind.unpacker.format
        values = [_value(letter, chance, 1000 + 20 * index) for letter in _letters(layout)]
        struct.pack_into(layout, content, 0, *values)
        yield _Raw(kind.id, kind.crc_extra, bytes(content))


class _Raw:
    """A message with this payload."""

    def __init__(self, number: int, crc_extra: int, content: bytes) -> None:
        self.number, self.crc_extra, self.content = number, crc_extra, content

    def pack(self, codec: Any) -> bytes:
        from pymavlink.dialects.v20 import common

        message = common.MAVLink_message(self.number, "RAW")
        message._pack(codec, self.crc_extra, self.content)
        return bytes(message.get_msgbuf())


def _letters(layout: str) -> list[str]:
    """One for each value; texts count as one."""
    found, number = [], ""
    for letter in layout.lstrip("<"):
        if letter.isdigit():
            number += letter
            continue
        found += [f"{number}s"] if letter == "s" else [letter] * int(number or 1)
        number = ""
    return found


def _value(letter: str, chance: random.Random, time_ms: int) -> Any:
    if letter.endswith("s"):
        return chance.randbytes(int(letter[:-1]))
    if letter in "fd":
        return chance.choice(FLOATS) if chance.random() < 0.7 else chance.uniform(-10, 10)
    size, signed = struct.calcsize(letter), letter.islower()
    value = time_ms if chance.random() < 0.3 else chance.choice(INTEGERS)
    return int.from_bytes((value & (256**size - 1)).to_bytes(size, "little"), "little", signed=signed)
