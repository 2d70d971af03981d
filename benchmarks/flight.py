"""A long flight on loopback: is anything lost, does the rate hold, does the memory stay flat?

    python benchmarks/flight.py model/model.onnx DATA --minutes 60 --viewer --busy 2 --out flight.json

`horizon-dl fly` replays the set in real time, again and again, as a process of its own; here is the peer,
which takes what an autopilot would: gaps in the sequence numbers are lost messages, and the times between
OBSTACLE_DISTANCE messages and the process's resident memory are kept for every minute. `--viewer` looks at
the live page twice a second; `--busy N` lets N processes of a low priority count beside it.
"""

import argparse
import json
import math
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import common

from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions

COMMAND = "import sys; from horizon_dl.cli import main; sys.exit(main(sys.argv[1:]))"
SILENT_S = 0.5
BUSY = "while True: pass"
VIEW_S = 0.5


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("model", type=Path)
    parser.add_argument("data", type=Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=20.0)
    parser.add_argument("--viewer", action="store_true", help="somebody looks at the live page")
    parser.add_argument("--busy", type=int, default=0, metavar="N", help="busy processes beside it (nice 15)")
    parser.add_argument("--out", type=Path, default=Path("flight.json"))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        own = Path(folder) / "flight.json"
        page = free_port() if arguments.viewer else None
        with busy(arguments.busy), watched(page) as views:
            found = flown(arguments.model, arguments.data, arguments.minutes * 60, arguments.rate, own, page)
        found |= {"busy": arguments.busy, "pictures viewed": views[0]}
        found["flight"] = json.loads(own.read_text())
    found |= {"versions": versions(), "machine": machine()}
    write_json(arguments.out, found)
    shown = ("received", "minutes", "memory_mb", "pictures viewed", "flight")
    print(json.dumps({key: found[key] for key in shown}, indent=1))


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
        return port


@contextmanager
def busy(count: int) -> Iterator[None]:
    """Processes that keep a core each busy, if nobody else wants it."""
    loops = [subprocess.Popen(["nice", "-n", "15", sys.executable, "-c", BUSY]) for _ in range(count)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()


@contextmanager
def watched(port: int | None) -> Iterator[list[int]]:
    """How many pictures of the live page somebody has got."""
    views, ended = [0], threading.Event()

    def look() -> None:
        while not ended.wait(VIEW_S):
            with suppress(OSError):
                for path in ("state.json", "picture.jpg"):
                    urllib.request.urlopen(f"http://127.0.0.1:{port}/{path}", timeout=5).read()
                views[0] += 1

    thread = threading.Thread(target=look, daemon=True)
    if port is not None:
        thread.start()
    yield views
    ended.set()


def flown(
    model: Path, data: Path, seconds: float, rate_hz: float, out: Path, page: int | None
) -> dict[str, Any]:
    """What the peer saw of one flight."""
    peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    peer.bind(("127.0.0.1", 0))
    peer.settimeout(0.2)
    url = f"udpout:127.0.0.1:{peer.getsockname()[1]}"
    options: tuple[str, ...] = (
        "--mavlink",
        url,
        "--rate",
        str(rate_hz),
        "--duration",
        str(seconds),
        "--out",
        str(out),
    )
    options += () if page is None else ("--serve", str(page))
    command = [sys.executable, "-c", COMMAND, "fly", str(model), "--source", str(data), "--loop", *options]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process, peer:
        sequence: list[int] = []
        minutes: list[dict[str, Any]] = []
        arrivals: list[float] = []
        start = time.monotonic()
        for arrived, message in _messages(peer, process):
            sequence.append(message.get_seq())
            if message.get_type() == "OBSTACLE_DISTANCE":
                arrivals.append(arrived)
            if arrived - start >= 60 * (len(minutes) + 1):
                minutes.append(_minute(arrivals, process.pid))
                arrivals = arrivals[-1:]
    if process.returncode:
        raise SystemExit(f"fly ended with {process.returncode}")
    steps = np.diff(sequence) % 256
    received = {"messages": len(sequence), "lost": int((steps - 1).sum())}
    settled = [minute["resident_mb"] for minute in minutes[1:]] or [math.nan]
    memory = {"after two minutes": settled[0], "at the end": settled[-1], "most": max(settled)}
    found = {"rate_hz": rate_hz, "seconds": seconds, "received": received, "minutes": minutes}
    return {**found, "memory_mb": memory}


def _messages(peer: socket.socket, process: "subprocess.Popen[bytes]") -> Iterator[tuple[float, Any]]:
    """Messages with their arrival, until the process has ended and nothing more comes."""
    parser = common.MAVLink(None)
    while True:
        try:
            content = peer.recv(65536)
        except TimeoutError:
            if process.poll() is not None:
                return
            continue
        for message in parser.parse_buffer(content) or []:
            yield time.monotonic(), message


def _minute(arrivals: list[float], pid: int) -> dict[str, Any]:
    gaps = np.diff(arrivals)
    status = Path(f"/proc/{pid}/status").read_text().splitlines()
    resident = next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
    return {
        "hz": round(1 / float(gaps.mean()), 2),
        "p99_gap_ms": round(1e3 * float(np.percentile(gaps, 99)), 1),
        "longest_gap_ms": round(1e3 * float(gaps.max()), 1),
        "silent": int((gaps > SILENT_S).sum()),
        "resident_mb": round(resident / 1024, 1),
    }


if __name__ == "__main__":
    main()
