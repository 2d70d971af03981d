"""A long flight on loopback: is anything lost, does the rate hold, does the memory stay flat?

    python benchmarks/flight.py model/model.onnx DATA --minutes 10 --out flight.json

`horizon-dl fly` replays the set in real time, again and again, as a process of its own; here is the peer,
which takes what an autopilot would: gaps in the sequence numbers are lost messages, and the times between
OBSTACLE_DISTANCE messages and the process's resident memory are kept for every minute.
"""

import argparse
import json
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import common

from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions

COMMAND = "import sys; from horizon_dl.cli import main; sys.exit(main(sys.argv[1:]))"
SILENT_S = 0.5


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("model", type=Path)
    parser.add_argument("data", type=Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=20.0)
    parser.add_argument("--out", type=Path, default=Path("flight.json"))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        own = Path(folder) / "flight.json"
        found = flown(arguments.model, arguments.data, arguments.minutes * 60, arguments.rate, own)
        found["flight"] = json.loads(own.read_text())
    found |= {"versions": versions(), "machine": machine()}
    write_json(arguments.out, found)
    print(json.dumps({key: found[key] for key in ("received", "minutes", "flight")}, indent=1))


def flown(model: Path, data: Path, seconds: float, rate_hz: float, out: Path) -> dict[str, Any]:
    """What the peer saw of one flight."""
    peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    peer.bind(("127.0.0.1", 0))
    peer.settimeout(0.2)
    url = f"udpout:127.0.0.1:{peer.getsockname()[1]}"
    options = ("--mavlink", url, "--rate", str(rate_hz), "--duration", str(seconds), "--out", str(out))
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
    return {"rate_hz": rate_hz, "seconds": seconds, "received": received, "minutes": minutes}


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
