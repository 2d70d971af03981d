"""The MAVLink 2 link to an autopilot: reads its messages, sends obstacle distances, heartbeats and texts."""

import hashlib
import os
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import InputError
from horizon_dl.vehicle.framing import SIGNED, VERSION_2, Framer
from horizon_dl.vehicle.obstacle_distance import MessageShape
from horizon_dl.vehicle.transport import Transport, open_transport

AUTOPILOT_COMPONENT = 1  # MAV_COMP_ID_AUTOPILOT1
OUR_COMPONENT = 196  # MAV_COMP_ID_OBSTACLE_AVOIDANCE
SIGNING_EPOCH_S = 1420070400.0  # 1 January 2015, in steps of 10 us
TEXT_LENGTH = 50
WARNING, INFO = 4, 6  # MAV_SEVERITY

ACCEPTED, FOREIGN, UNSIGNED, GARBAGE = "accepted", "foreign_system", "bad_signature", "garbage"


class Link:
    """Messages of one autopilot.

    What comes from another system or component, without the right signature, or is no MAVLink, is ignored
    and counted in `counts`; nothing of it raises. `strangers` are the system ids of other autopilots heard.

    Args:
        transport: the line.
        system: the vehicle's system id; ours is the same, as for every part of a vehicle.
        key: 32 bytes for MAVLink 2 signing, or None: unsigned messages are taken.
    """

    def __init__(self, transport: Transport, system: int = 1, key: bytes | None = None) -> None:
        os.environ.setdefault("MAVLINK20", "1")
        from pymavlink.dialects.v20 import common

        self.counts: Counter[str] = Counter()
        self.strangers: set[int] = set()
        self._dialect: Any = common
        self._transport = transport
        self._system = system
        self._incoming: Any = self._new_codec(key, sign=False)
        self._outgoing: Any = self._new_codec(key, sign=key is not None)
        self._sending = threading.Lock()
        self._framer = Framer()

    def receive(self, timeout_s: float) -> list[Any]:
        """The good messages of the next bytes, pymavlink's objects; empty after the timeout."""
        content, peer = self._transport.receive(timeout_s)
        if not content:
            return []
        good = [message for message in self._parsed(content) if self._is_wanted(message)]
        if good and not self._transport.accept(peer):
            self.counts[FOREIGN] += len(good)
            return []
        self.counts[ACCEPTED] += len(good)
        return good

    def send_distances(self, time_s: float, cm: NDArray[np.uint16], shape: MessageShape) -> bool:
        """Send OBSTACLE_DISTANCE in the body's frame; whether it has left.

        Args:
            time_s: of the image, seconds since our system's start (or any monotonic clock).
            cm: (72,) of `distances_cm`.
            shape: of the same.
        """
        mav = self._dialect
        return self._send(
            mav.MAVLink_obstacle_distance_message(
                time_usec=int(time_s * 1e6),
                sensor_type=mav.MAV_DISTANCE_SENSOR_UNKNOWN,
                distances=cm.tolist(),
                increment=round(shape.increment_deg),
                min_distance=shape.min_cm,
                max_distance=shape.max_cm,
                increment_f=shape.increment_deg,
                angle_offset=shape.offset_deg,
                frame=mav.MAV_FRAME_BODY_FRD,
            )
        )

    def send_heartbeat(self) -> bool:
        """Say that we are there, as a companion computer; due once a second."""
        mav = self._dialect
        return self._send(
            mav.MAVLink_heartbeat_message(
                mav.MAV_TYPE_ONBOARD_CONTROLLER, mav.MAV_AUTOPILOT_INVALID, 0, 0, mav.MAV_STATE_ACTIVE, 3
            )
        )

    def send_text(self, text: str, severity: int = WARNING) -> bool:
        """Send a STATUSTEXT for the pilot, cut to 50 characters."""
        content = text.encode("ascii", "replace")[:TEXT_LENGTH]
        return self._send(self._dialect.MAVLink_statustext_message(severity, content))

    def close(self) -> None:
        """Let go of the line."""
        self._transport.close()

    def _send(self, message: Any) -> bool:
        with self._sending:
            ours, theirs = self._outgoing.signing, self._incoming.signing
            # A receiver refuses stamps of more than a minute ago, by its own clock or that of its peers.
            ours.timestamp = max(ours.timestamp, theirs.timestamp, _signing_stamp())
            content = bytes(message.pack(self._outgoing))
            self._outgoing.seq = (self._outgoing.seq + 1) % 256
            return self._transport.send(content)

    def _parsed(self, content: bytes) -> list[Any]:
        found, stretches = self._framer.take(content, self._decoded)
        if self._transport.whole_messages:
            # A datagram holds whole messages: the next one does not continue what is left of this one.
            stretches += self._framer.forget()
        if stretches:
            self.counts[GARBAGE] += stretches
        return found

    def _decoded(self, frame: bytearray) -> list[Any] | None:
        """See `framing.Decode`."""
        if frame[0] == VERSION_2 and frame[2] & ~SIGNED:
            return None  # flags of a later version, which change what a frame is
        try:
            message = self._incoming.decode(frame)
        except self._dialect.MAVError as error:
            if "signature" not in str(error):
                return None
            self.counts[UNSIGNED] += 1
            return []
        except Exception:  # a parser of foreign bytes; the loop goes on whatever it trips over
            return None
        if message.get_type().startswith("UNKNOWN"):
            return []  # of another dialect: nobody here can check its sum
        return [message]

    def _is_wanted(self, message: Any) -> bool:
        sender = (message.get_srcSystem(), message.get_srcComponent())
        if sender != (self._system, AUTOPILOT_COMPONENT):
            self.counts[FOREIGN] += 1
            if sender[1] == AUTOPILOT_COMPONENT and message.get_type() == "HEARTBEAT":
                self.strangers.add(sender[0])
            return False
        return True

    def _new_codec(self, key: bytes | None, sign: bool) -> Any:
        codec = _careful(self._dialect)(None, srcSystem=self._system, srcComponent=OUR_COMPONENT)
        if key is not None:
            codec.signing.secret_key = key
            codec.signing.sign_outgoing = sign
            codec.signing.timestamp = _signing_stamp()
        return codec


def _signing_stamp() -> int:
    """Now in MAVLink's signing time, steps of 10 us since 2015; 0 on a clock that was never set."""
    return max(0, int((time.time() - SIGNING_EPOCH_S) * 1e5))


def open_link(url: str, system: int = 1, signing_key: Path | None = None) -> Link:
    """The link over an address; see `open_transport`, `Link` and `read_signing_key`."""
    key = None if signing_key is None else read_signing_key(signing_key)
    return Link(open_transport(url), system, key)


def _careful(dialect: Any) -> Any:
    """pymavlink's codec, which keeps the time stamp of a message even if its signature is wrong.

    A forged message from the future would then shut out the true sender; here its stamp is forgotten.
    """

    class Careful(dialect.MAVLink):  # type: ignore[misc]
        def check_signature(self, msgbuf: bytearray, srcSystem: int, srcComponent: int) -> bool:  # noqa: N803
            before = dict(self.signing.stream_timestamps)
            good = bool(super().check_signature(msgbuf, srcSystem, srcComponent))
            if not good:
                self.signing.stream_timestamps = before
            return good

    return Careful


def read_signing_key(path: Path) -> bytes:
    """32 bytes from a file: as they are, as 64 hexadecimal digits, or else SHA-256 of the pass phrase in it.

    Raises:
        InputError: no such file, or it is empty.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "give the file with the key") from None
    if len(content) == 32:
        return content
    text = content.strip()
    if not text:
        raise InputError(path, "is empty", "write the pass phrase or 64 hexadecimal digits into it")
    try:
        return bytes.fromhex(text.decode()) if len(text) == 64 else hashlib.sha256(text).digest()
    except ValueError:
        return hashlib.sha256(text).digest()
