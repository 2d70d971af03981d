"""What it costs a flight to be watched: the same replay alone, recorded, and recorded with a browser looking.

  python benchmarks/viewer_cost.py [--seconds 15]

The embedded flight at three times its pace, the reference model, messages to a port where nobody listens.
"""

import argparse
import contextlib
import io
import json
import tempfile
import threading
import urllib.request
from pathlib import Path
from typing import Any

from horizon_dl.cli import main
from horizon_dl.simulation.embedded import embedded_set

MODEL = Path(__file__).parents[1] / "exports" / "reference" / "model.onnx"
PORT = 18765
LOOK_S = 0.2


def flown(folder: Path, name: str, seconds: float, *more: str) -> dict[str, Any]:
    """The figures of one replay."""
    out = folder / f"{name}.json"
    arguments = ["fly", str(MODEL), "--source", str(embedded_set()), "--mavlink", "udpout:127.0.0.1:9"]
    arguments += ["--speed", "3", "--loop", "--duration", str(seconds), "--out", str(out), *more]
    with contextlib.redirect_stdout(io.StringIO()):
        assert main(arguments) == 0
    figures: dict[str, Any] = json.loads(out.read_text())
    return figures


def look(stopped: threading.Event) -> None:
    """As the page's script does: figures and picture, five times a second."""
    while not stopped.wait(LOOK_S):
        with contextlib.suppress(OSError):
            for path in ("state.json", "picture.jpg"):
                urllib.request.urlopen(f"http://127.0.0.1:{PORT}/{path}", timeout=5).read()


def line(name: str, figures: dict[str, Any], seconds: float) -> str:
    def shown(kind: str, which: str) -> str:
        value = figures[kind][which]
        return "-" if value is None else f"{value:.0f}"

    return (
        f"{name:<28} {figures['period']['count'] / seconds:5.1f} messages/s, period 99 % "
        f"{shown('period', 'p99_ms')} ms; {figures['pictures']['looked_at'] / seconds:5.1f} pictures/s, from "
        f"image to message median {shown('latency', 'median_ms')} ms, 99 % {shown('latency', 'p99_ms')} ms"
    )


def run() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=15.0)
    seconds = parser.parse_args().seconds
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(line("alone", flown(folder, "alone", seconds), seconds), flush=True)
        record = ["--record", str(folder / "recorded")]
        print(line("--record", flown(folder, "recorded", seconds, *record), seconds), flush=True)
        stopped = threading.Event()
        looker = threading.Thread(target=look, args=(stopped,))
        looker.start()
        record = ["--record", str(folder / "watched"), "--serve", str(PORT)]
        print(line("--record --serve, watched", flown(folder, "watched", seconds, *record), seconds))
        stopped.set()
        looker.join()


if __name__ == "__main__":
    run()
