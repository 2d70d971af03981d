"""How fast model files are on this machine, and where the milliseconds go."""

import io
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.provenance import machine, versions
from horizon_dl.runtime.checksum import read_checksummed
from horizon_dl.runtime.model import ObstacleModel, new_session

WARM_UP = 5
BLOCK = 5
STAGES = ("resize", "encode", "uncertainty", "horizon", "measures", "obstacles")
COLD_START = (
    "import sys, numpy as np\n"
    "from horizon_dl.runtime.model import ObstacleModel\n"
    "m = ObstacleModel.load(sys.argv[1])\n"
    "m.predict(np.zeros((m.camera.height, m.camera.width, 3), np.uint8))"
)

Feed = dict[str, NDArray[Any]]


def benchmark(paths: Sequence[Path], threads: Sequence[int], runs: int) -> dict[str, Any]:
    """Figures of several files, ready for JSON.

    The configurations take turns in blocks of five runs, so that a load that comes and goes meets them all.

    Args:
        paths: model files, each for its own image size.
        threads: numbers of threads within an operator.
        runs: of each file and number of threads, after five that do not count.

    Raises:
        InputError: a file is no model file, or damaged.
    """
    load_before = os.getloadavg()[0]
    models = [ObstacleModel.load(path) for path in paths]
    feeds = [example_feed(model) for model in models]
    sessions: dict[tuple[int, int], Callable[[], object]] = {}
    for index, path in enumerate(paths):
        for count in threads:
            sessions[index, count] = _runner(read_checksummed(path)[0], count, feeds[index])
    times = timed_in_turn(sessions, runs)
    files = []
    for index, (path, model) in enumerate(zip(paths, models, strict=True)):
        by_threads = {str(count): quartiles(times[index, count]) for count in threads}
        for count in threads:
            by_threads[str(count)]["stages_ms"] = stages(path, count, feeds[index])
        files.append({**_facts(path, model), "threads": by_threads})
    return {
        "schema": 1,
        "runs": runs,
        "machine": {**machine(), "load_average_before": round(load_before, 2)},
        "versions": versions(),
        "models": files,
    }


def example_feed(model: ObstacleModel) -> Feed:
    """An image of smooth random colours and an attitude, as the graph takes them."""
    return {"image": example_image(model)[None], "up_cam": np.array([0.0, -0.98, 0.199], np.float32)}


def example_image(model: ObstacleModel) -> NDArray[np.uint8]:
    """(H, W, 3) uint8."""
    coarse = np.random.default_rng(0).integers(0, 256, (12, 16, 3), dtype=np.uint8)
    size = (model.camera.width, model.camera.height)
    return np.array(Image.fromarray(coarse).resize(size, Image.Resampling.BICUBIC))


def timed_in_turn(jobs: dict[Any, Callable[[], object]], runs: int) -> dict[Any, list[float]]:
    """Milliseconds of `runs` runs of every job, in turns of five, after a warm-up."""
    times: dict[Any, list[float]] = {name: [] for name in jobs}
    for job in jobs.values():
        for _ in range(WARM_UP):
            job()
    while any(len(found) < runs for found in times.values()):
        for name, job in jobs.items():
            for _ in range(min(BLOCK, runs - len(times[name]))):
                start = time.perf_counter()
                job()
                times[name].append(1e3 * (time.perf_counter() - start))
    return times


def quartiles(milliseconds: Sequence[float]) -> dict[str, Any]:
    """Median and quartiles, ms.

    Example:
        >>> quartiles([1.0, 2.0, 3.0, 4.0, 5.0])
        {'median_ms': 3.0, 'q1_ms': 2.0, 'q3_ms': 4.0}
    """
    low, middle, high = np.percentile(milliseconds, [25, 50, 75])
    return {"median_ms": float(middle), "q1_ms": float(low), "q3_ms": float(high)}


def stages(path: Path, threads: int, feed: Feed, runs: int = 20) -> dict[str, float]:
    """Median milliseconds of each stage of the graph, from onnxruntime's profiler (which adds a little).

    Nodes belong to the module in front of their name; what onnxruntime itself puts in is `other`.
    """
    with tempfile.TemporaryDirectory() as folder:
        prefix = str(Path(folder) / "profile")
        options = {"enable_profiling": True, "profile_file_prefix": prefix}
        session = new_session(read_checksummed(path)[0], threads, **options)
        for _ in range(WARM_UP + runs):
            session.run(None, feed)
        events = json.loads(Path(session.end_profiling()).read_text())
    by_node: dict[str, list[float]] = defaultdict(list)
    for event in events:
        if event.get("cat") == "Node" and event["name"].endswith("_kernel_time"):
            by_node[event["name"]].append(event["dur"] / 1e3)
    found = dict.fromkeys((*STAGES, "other"), 0.0)
    for name, durations in by_node.items():
        found[stage_of(name)] += float(np.median(durations))
    return {name: round(value, 4) for name, value in found.items()}


def stage_of(node: str) -> str:
    """The stage that a node belongs to.

    Example:
        >>> stage_of("/encode/encoder/encoder.0/Conv_kernel_time")
        'encode'
    """
    if node.startswith("Reorder"):
        return "encode"  # changes of memory layout around the convolutions
    first = node.removeprefix("/").partition("/")[0]
    return first if first in STAGES else "other"


def cold_start_s(path: Path) -> float:
    """Seconds from starting Python to the first prediction, in a process of its own."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", COLD_START, str(path)], check=True, capture_output=True)
    return time.perf_counter() - start


def _runner(content: bytes, threads: int, feed: Feed) -> Callable[[], object]:
    session = new_session(content, threads)
    return lambda: session.run(None, feed)


def _facts(path: Path, model: ObstacleModel) -> dict[str, Any]:
    jpeg = io.BytesIO()
    Image.fromarray(example_image(model)).save(jpeg, "JPEG", quality=90)
    decode = timed_in_turn({"decode": lambda: Image.open(io.BytesIO(jpeg.getvalue())).load()}, 20)["decode"]
    return {
        "file": path.name,
        "sha256": model.sha256,
        "weights_sha256": model.card["weights_sha256"],
        "bytes": path.stat().st_size,
        "image_size": [model.camera.width, model.camera.height],
        "working_size": list(model.size),
        "cold_start_s": round(cold_start_s(path), 3),
        "decode_jpeg_ms": quartiles(decode)["median_ms"],
    }
