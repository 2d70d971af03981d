"""Where the time of an online learner goes, at 320x240: prediction alone, and all that a frame costs.

    python benchmarks/online_stages.py [--threads 2] [--frames 40] [--out FILE]

Medians and quartiles over the frames of the embedded set, brought to 320x240; rates from the means, since
every other frame also makes an old target anew. Processor time is summed over the threads: with one thread
it is about what the clock would show on a machine where nothing else runs. `learn` is the learner's own
`learn`, whole: target, packing, and all steps of a later frame; the lines below it are its parts, measured
one by one.
"""

import argparse
import os
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from horizon_dl.config import load_config
from horizon_dl.data.frame import Frame
from horizon_dl.data.view import make_view
from horizon_dl.geometry.resize import area_resize, halved
from horizon_dl.online.guard import StreamGuard
from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.training.crops import draw_batch
from horizon_dl.training.half_resolution import guide_of, half_resolution_frame
from horizon_dl.training.online.compression import pack, unpack
from horizon_dl.training.online.learner import OnlineLearner

SIZE = (320, 240)
Taken = tuple[float, float]

WANTED_HZ = {"predict": 30.0, "predict and learn": 10.0}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--data", type=Path, help="a data set in place of the embedded one")
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    load_before = os.getloadavg()
    times = measure(arguments.data or embedded_set(), arguments.frames)
    rows = {name: summary(taken) for name, taken in times.items()}
    print(f"{arguments.threads} threads, load {load_before[0]:.1f} before and {os.getloadavg()[0]:.1f} after")
    for name, row in rows.items():
        (low, median, high), processor = row["clock_ms"], row["cpu_ms"][1]
        print(f"{name:34s} clock {median:8.2f} ms ({low:.2f} to {high:.2f}), processor {processor:8.2f} ms")
    rates: dict[str, dict[str, float]] = {}
    for place, kind in enumerate(("clock_ms", "cpu_ms")):
        predict_ms, learn_ms = (
            float(np.mean([taken[place] for taken in times[name]]))
            for name in ("predict, 16 samples", "learn")
        )
        rates[kind] = {"predict": 1e3 / predict_ms, "predict and learn": 1e3 / (predict_ms + learn_ms)}
        for name, rate in rates[kind].items():
            print(f"{name}, by {kind}: {rate:.1f} Hz (wanted: {WANTED_HZ[name]:g})")
    if arguments.out:
        content: dict[str, Any] = {"quartiles": rows, "hz": rates, "load": [load_before, os.getloadavg()]}
        write_json(arguments.out, {**content, "versions": versions(), "machine": machine()})


def summary(taken: list[Taken]) -> dict[str, list[float]]:
    """Quartiles, ms."""
    kinds = zip(("clock_ms", "cpu_ms"), zip(*taken, strict=True), strict=True)
    return {kind: [float(np.percentile(values, q)) for q in (25, 50, 75)] for kind, values in kinds}


def measure(data: Path, count: int) -> dict[str, list[Taken]]:
    """Milliseconds by stage, of the clock and of the processor, for each of the later frames."""
    config = load_config()
    learner, guard = OnlineLearner(config), StreamGuard()
    recording = open_recording(data)
    usable = [i for i, entry in enumerate(recording.headers) if entry.up_cam is not None]
    rng = np.random.default_rng(0)
    times: dict[str, list[Taken]] = {}

    def timed(name: str, action: Callable[..., Any], *given: Any) -> Any:
        clock, processor = time.perf_counter(), time.process_time()
        result = action(*given)
        taken = (1e3 * (time.perf_counter() - clock), 1e3 * (time.process_time() - processor))
        times.setdefault(name, []).append(taken)
        return result

    early = config.online.warm_up_frames
    for number in range(early + count):
        index = usable[number % len(usable)]
        if number == early:
            times.clear()
        frame = brought_to(timed("load", recording.read, index), SIZE)
        view = timed("view", make_view, frame, SIZE[0] * SIZE[1])
        timed("guard", guard.check, frame)
        timed("predict, 16 samples", learner.predict, view)
        timed("learn", learner.learn, view)
        if number < early:
            continue
        newest = timed(
            "  target, with the net's edges", half_resolution_frame, view, config, guide_of(learner.net)
        )
        packed = timed("  replay: pack", pack, newest, halved(view.elevation))
        timed("  replay: unpack one", unpack, packed)
        drawn = timed("  replay: draw a batch's frames", learner.memory.draw, config.online.batch - 1)
        batch = timed("  crops", draw_batch, [newest, *drawn], config.online.crop, rng)
        timed("  step", learner._step, batch)
    return times


def brought_to(frame: Frame, size: tuple[int, int]) -> Frame:
    """The frame at a size of nearly its aspect."""
    camera = frame.calibrated
    if (camera.width, camera.height) == size:
        return frame
    return replace(frame, image=area_resize(frame.image, size), camera=camera.scaled(*size))


if __name__ == "__main__":
    main()
