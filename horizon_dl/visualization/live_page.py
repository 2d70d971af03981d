"""A live page over HTTP: the newest picture, distances over bearings and the run's figures; read-only."""

import io
import json
import math
import secrets
import threading
from collections.abc import Callable
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from ipaddress import ip_address
from typing import Any
from urllib.parse import parse_qs, urlsplit

from PIL import Image as PilImage

from horizon_dl.data.frame import Frame
from horizon_dl.errors import InputError
from horizon_dl.ranging.sectors import Outcome
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.film_picture import FilmPicture
from horizon_dl.visualization.flown import unknown_words

Status = Callable[[], dict[str, Any]]

HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src 'self' data:; connect-src 'self'; frame-ancestors 'none'",
}


@dataclass(frozen=True)
class Address:
    """Where to listen."""

    host: str
    port: int

    @classmethod
    def parse(cls, text: str) -> "Address":
        """`[HOST:]PORT`; without a host this machine alone can look.

        Example:
            >>> Address.parse("8000")
            Address(host='127.0.0.1', port=8000)
        """
        host, _, port = text.rpartition(":")
        if not port.isdigit() or int(port) > 65535:
            raise InputError(f"--serve {text}", "is no [HOST:]PORT", "give for example 8000")
        return cls(host.strip("[]") or "127.0.0.1", int(port))

    @property
    def local(self) -> bool:
        """Whether only this machine can look."""
        if self.host == "localhost":
            return True
        try:
            return ip_address(self.host).is_loopback
        except ValueError:
            return False


class LivePage:
    """A sink and a server. Pictures are drawn when a browser asks for them: without one it costs nothing.

    Args:
        address: where it listens; port 0 takes a free one.
        title: of the page.
        status: the run's figures, asked for whenever a browser does.

    Attributes:
        url: to open in a browser, with the token that is needed where others can connect.

    Raises:
        InputError: the address cannot be listened on.
    """

    def __init__(self, address: Address, title: str, status: Status = dict) -> None:
        self._newest: tuple[Frame, Prediction, Ranged | None] | None = None
        self._count, self._title, self._status = 0, title, status
        self._drawn: tuple[int, bytes] = (0, b"")
        self._drawing = threading.Lock()
        self._picture = FilmPicture(with_ground=True, cell_width=320)
        self.token = "" if address.local else secrets.token_urlsafe(16)
        try:
            self._server = _Server((address.host, address.port), _handler_of(self))
        except OSError as error:
            where = f"--serve {address.host}:{address.port}"
            raise InputError(
                where, f"cannot be listened on ({error.strerror})", "take another port"
            ) from None
        self.port = int(self._server.server_address[1])
        shown = address.host if address.local else _reachable(address.host)
        self.url = f"http://{shown}:{self.port}/" + (f"?token={self.token}" if self.token else "")
        self.hosts = {f"{name}:{self.port}" for name in (address.host, "localhost", "127.0.0.1")}
        threading.Thread(target=self._server.serve_forever, name="page", daemon=True).start()

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`; keeps the frame, draws nothing."""
        self._newest = (frame, prediction, ranges)
        self._count += 1

    def close(self) -> None:
        """End the server; who looks keeps the last picture."""
        self._server.shutdown()
        self._server.server_close()

    def state(self) -> dict[str, Any]:
        """What the page shows beside the picture."""
        found: dict[str, Any] = {"title": self._title, "frame": self._count, "status": self._status()}
        if self._newest is not None:
            frame, _, ranges = self._newest
            found |= {"name": frame.name, "time_s": _finite(frame.time_s), "ranges": _sectors(ranges)}
        return found

    def picture(self) -> bytes:
        """The newest frame as a JPEG; drawn once, however many look."""
        with self._drawing:
            count, newest = self._count, self._newest
            if newest is not None and count != self._drawn[0]:
                buffer = io.BytesIO()
                PilImage.fromarray(self._picture(*newest)).save(buffer, "JPEG", quality=80)
                self._drawn = (count, buffer.getvalue())
            return self._drawn[1]


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing: a browser that leaves while it is answered is no event."""


def _handler_of(page: LivePage) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        server_version, sys_version = "horizon-dl", ""
        timeout = 10

        def do_GET(self) -> None:
            parts = urlsplit(self.path)
            if not self._allowed(parse_qs(parts.query).get("token", [""])[0]):
                return self._answer(403, "text/plain", b"not allowed: open the address as it was printed\n")
            if parts.path == "/":
                return self._answer(200, "text/html; charset=utf-8", _html())
            if parts.path == "/state.json":
                return self._answer(200, "application/json", json.dumps(page.state()).encode())
            if parts.path == "/picture.jpg" and (content := page.picture()):
                return self._answer(200, "image/jpeg", content)
            return self._answer(404, "text/plain", b"not there\n")

        def log_message(self, format: str, *_: Any) -> None:
            """Say nothing: the terminal is the run's."""

        def _allowed(self, token: str) -> bool:
            if page.token:
                return secrets.compare_digest(token.encode(), page.token.encode())
            # A web site that a browser here has open must not read the page by a name of its own.
            return self.headers.get("Host", "") in page.hosts

        def _answer(self, code: int, kind: str, content: bytes) -> None:
            self.send_response(code)
            for name, value in {**HEADERS, "Content-Type": kind, "Content-Length": len(content)}.items():
                self.send_header(name, str(value))
            self.end_headers()
            self.wfile.write(content)

    return Handler


def _html() -> bytes:
    return files("horizon_dl.visualization").joinpath("assets", "live.html").read_bytes()


def _reachable(host: str) -> str:
    import socket

    return socket.gethostname() if host in ("0.0.0.0", "::") else host


def _sectors(ranges: Ranged | None) -> dict[str, Any] | None:
    if ranges is None:
        return None
    found = ranges.found
    return {
        "bearing_deg": [round(math.degrees(one), 2) for one in found.bearing_rad.tolist()],
        "outcome": [Outcome(one).name.lower() for one in found.outcome.tolist()],
        "metres": [_finite(one) for one in found.distance_m.tolist()],
        "far_m": ranges.vehicle.far_m,
        "unknown": unknown_words(ranges),
        "heading_deg": None if ranges.heading is None else round(math.degrees(ranges.heading.bearing_rad), 1),
    }


def _finite(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None
