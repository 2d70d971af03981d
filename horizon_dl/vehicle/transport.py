"""Bytes to and from the autopilot: UDP or a serial line, and nothing else listens.

`udpout:HOST:PORT` talks to that address alone; `udpin:HOST:PORT` listens there, on that address only, and
answers to the one peer whose messages were found good; `serial:DEVICE[:BAUD]` needs pyserial.
"""

import select
import socket
import time
from contextlib import suppress
from typing import Any, Protocol

from horizon_dl.errors import InputError

LARGEST_DATAGRAM = 65536
PEER_SILENT_S = 5.0
DEFAULT_BAUD = 921600
REOPEN_S = 0.5
"""A serial line that was lost is opened again after this time."""
FORMS = "write udpout:HOST:PORT, udpin:HOST:PORT or serial:DEVICE:BAUD"

Peer = tuple[str, int] | None


class Transport(Protocol):
    """What the link needs."""

    whole_messages: bool

    def receive(self, timeout_s: float) -> tuple[bytes, Peer]:
        """Bytes that have come and from whom; nothing after the timeout or on errors of the line."""

    def accept(self, peer: Peer) -> bool:
        """A good message came from there; whether it is the peer that is talked to."""

    def send(self, content: bytes) -> bool:
        """Whether the bytes have left."""

    def close(self) -> None:
        """Let go of the line."""


def _datagram(line: socket.socket, timeout_s: float) -> tuple[bytes, Peer]:
    """The next datagram and its sender; nothing after the timeout, or where nobody is there yet."""
    try:
        if select.select([line], [], [], timeout_s)[0]:
            content, (host, port) = line.recvfrom(LARGEST_DATAGRAM)
            return content, (host, port)
    except (OSError, ValueError):  # refused, or closed meanwhile
        time.sleep(min(timeout_s, 0.05))
    return b"", None


def _has_left(line: socket.socket, content: bytes, address: Peer = None) -> bool:
    try:
        sent = line.send(content) if address is None else line.sendto(content, address)
        return sent == len(content)
    except OSError:
        return False


class UdpOut:
    """UDP to one fixed address; the system drops what comes from others."""

    whole_messages = True

    def __init__(self, host: str, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect((host, port))

    def receive(self, timeout_s: float) -> tuple[bytes, Peer]:
        """See `Transport`."""
        return _datagram(self._socket, timeout_s)[0], None

    def accept(self, peer: Peer) -> bool:
        """See `Transport`."""
        return True

    def send(self, content: bytes) -> bool:
        """See `Transport`."""
        return _has_left(self._socket, content)

    def close(self) -> None:
        """See `Transport`."""
        self._socket.close()


class UdpIn:
    """UDP on one local address; answers to the first peer whose messages are good, until it is silent."""

    whole_messages = True

    def __init__(self, host: str, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((host, port))
        self._peer: Peer = None
        self._heard_s = 0.0

    @property
    def address(self) -> tuple[str, int]:
        """Where it listens."""
        host, port = self._socket.getsockname()
        return str(host), int(port)

    def receive(self, timeout_s: float) -> tuple[bytes, Peer]:
        """See `Transport`."""
        return _datagram(self._socket, timeout_s)

    def accept(self, peer: Peer) -> bool:
        """See `Transport`."""
        now = time.monotonic()
        if self._peer is None or now - self._heard_s > PEER_SILENT_S:
            self._peer = peer
        if peer != self._peer:
            return False
        self._heard_s = now
        return True

    def send(self, content: bytes) -> bool:
        """See `Transport`."""
        return self._peer is not None and _has_left(self._socket, content, self._peer)

    def close(self) -> None:
        """See `Transport`."""
        self._socket.close()


class Serial:
    """A serial line, through pyserial; one that is lost is opened again when it is back.

    Only `receive` opens, so the line needs no lock between the thread that reads and those that send.
    """

    whole_messages = False

    def __init__(self, device: str, baud: int) -> None:
        self._device, self._baud = device, baud
        self._closed = False
        self._tried_s = 0.0
        self._line: Any = self._open()

    def receive(self, timeout_s: float) -> tuple[bytes, Peer]:
        """See `Transport`."""
        try:
            if self._line is None:
                self._reopen()
            self._line.timeout = timeout_s
            first = self._line.read(1)
            return bytes(first + self._line.read(self._line.in_waiting)), None
        except Exception:  # of a line that is gone pyserial lets OSError, TypeError, termios.error through
            self._lose()
            time.sleep(min(timeout_s, 0.05))
            return b"", None

    def accept(self, peer: Peer) -> bool:
        """See `Transport`."""
        return True

    def send(self, content: bytes) -> bool:
        """See `Transport`."""
        try:
            return bool(self._line.write(content) == len(content))
        except Exception:  # as above; the line may also be closed, or None
            return False

    def close(self) -> None:
        """See `Transport`."""
        self._closed = True
        self._lose()

    def _open(self) -> Any:
        import serial

        return serial.Serial(self._device, self._baud, timeout=0.05, write_timeout=0.2)

    def _reopen(self) -> None:
        """Raises whatever keeps the line from being open."""
        now = time.monotonic()
        if self._closed or now - self._tried_s < REOPEN_S:
            raise OSError("not open")
        self._tried_s = now
        self._line = self._open()

    def _lose(self) -> None:
        line, self._line = self._line, None
        if line is not None:
            self._tried_s = time.monotonic()
            with suppress(OSError):
                line.close()


def open_transport(url: str) -> Transport:
    """The line that a URL names.

    Raises:
        InputError: the URL is of no known form, or the line cannot be opened.
    """
    kind, _, place = url.partition(":")
    host, _, number = place.rpartition(":")
    if kind == "serial" and not number.isdigit():
        host, number = place, str(DEFAULT_BAUD)
    valid = kind in ("udpout", "udpin", "serial") and host and number.isdigit()
    if not valid or (kind != "serial" and not 0 <= int(number) <= 65535):
        raise InputError(f"--mavlink {url}", "is no address", FORMS)
    try:
        if kind == "serial":
            return Serial(host, int(number))
        return UdpOut(host, int(number)) if kind == "udpout" else UdpIn(host, int(number))
    except OSError as error:
        hint = "check address and device, and that nothing else uses them"
        raise InputError(f"--mavlink {url}", f"cannot be opened ({error.strerror or error})", hint) from None
