"""The deployed uncertain map against everything it could be replaced by, side by side in one run.

  python benchmarks/deployed_model.py [--out FILE] [--rounds N]

All at 320x240 and one thread, on the same picture. In every round every candidate runs (the quick ones ten
times, the slow ones once), so a load that comes and goes meets them all. Times are processor times of the one
thread, which other programs on the machine lengthen far less than they do the clock's; medians and quartiles
are over all runs, and the clock's median stands beside them.

The nets' weights are random: times do not depend on them. The forest's do, so it is fitted to frames of the
embedded flight, with the default number of pixels. The sampled net and the forest have the same work to do as
the uncertain map: from the camera's bytes to the obstacle map, all measures from all samples at full size
(`sampled_net.py`). The passes of the sampled net run as one batch, or one after the other, which keeps their
features in the cache. The convolution bound is the time that the net's multiply-adds would take at the best
rate of any of a few usual convolutions.
"""

import argparse
import os
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from depth_net import DepthNet
from numpy.typing import NDArray
from sampled_net import SAMPLES, THRESHOLD, Batch, Passes, Summary, naive_torch
from torch import Tensor, nn

from horizon_dl.config import Config
from horizon_dl.data.evenly import evenly
from horizon_dl.data.view import View, make_view
from horizon_dl.export.encode import Encode
from horizon_dl.export.graph import Pipeline
from horizon_dl.export.onnx_file import graph_of
from horizon_dl.export.parity import feed_of
from horizon_dl.geometry.camera import Camera
from horizon_dl.models.build import build_net, parameter_count
from horizon_dl.models.encoded import image_tensor
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.forest import HorizonForest
from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.benchmark import quartiles
from horizon_dl.runtime.model import new_session
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.uncertainty.measures import measures
from horizon_dl.uncertainty.obstacle_map import obstacle_map

FRAMES = 8  # of the embedded flight, to fit the forest to
DEPTH_HEIGHT, DEPTH_WIDTH = 518, 686  # what Depth-Anything makes of 320x240: the shorter side 518
QUICK_RUNS = 10
WANTED = {
    "single pass": ("at most", 1.1),
    "net sampled 16 times, one batch": ("at least", 25.0),
    "net sampled 16 times, one by one": ("at least", 25.0),
    "net sampled 16 times, torch": ("at least", 25.0),
    "forest": ("at least", 100.0),
    "forest, exported": ("at least", 100.0),
    "depth network": ("at least", 50.0),
    "convolution bound": ("at most", 2.0),
}

Job = Callable[[], object]
Taken = tuple[float, float]
Feed = dict[str, NDArray[Any]]


class Sampled(nn.Module):
    """The deployed net without what comes after it: all samples' logits on its coarse grid."""

    def __init__(self, net: HorizonFCN) -> None:
        super().__init__()
        self.net, self.encode = net, Encode(net, interleaved=True)

    def forward(self, image: Tensor) -> Tensor:
        """(1, samples, h / s, w / s) of (1, h, w, 3) uint8."""
        return self.net.sample_logits(self.encode(image))


def session_of(module: nn.Module, inputs: tuple[Tensor, ...], names: list[str]) -> Any:
    """A module in onnxruntime, one thread."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder) / "model.onnx"
        torch.onnx.export(module.eval(), inputs, path, dynamo=False, opset_version=18, input_names=names)
        return new_session(path.read_bytes(), 1)


def exported_job(module: nn.Module, inputs: tuple[Tensor, ...], names: list[str]) -> Job:
    """A module through onnxruntime, one thread."""
    session = session_of(module, inputs, names)
    feed = {name: value.numpy() for name, value in zip(names, inputs, strict=True)}
    return lambda: session.run(None, feed)


def one_by_one_job(net: HorizonFCN, camera: Camera, feed: Feed) -> Job:
    """Sixteen runs of one pass, and one of the summary."""
    image, up_cam = torch.from_numpy(feed["image"]), torch.from_numpy(feed["up_cam"])
    samples = torch.rand(SAMPLES, camera.height, camera.width)
    one_pass = session_of(Passes(net, 1), (image,), ["image"])
    summary = session_of(Summary(camera), (samples, up_cam), ["samples", "up_cam"])

    def run() -> object:
        passes = [one_pass.run(None, {"image": feed["image"]})[0] for _ in range(SAMPLES)]
        return summary.run(None, {"samples": np.concatenate(passes), "up_cam": feed["up_cam"]})

    return run


def whole_way_job(
    learner: HorizonFCN | HorizonForest, camera: Camera, feed: Feed, *, sampled: bool = True
) -> Job:
    """Camera image to obstacle map, as it is deployed."""
    module = Pipeline(learner, camera, camera.width * camera.height, THRESHOLD, sampled=sampled)
    session = new_session(graph_of(module).SerializeToString(), 1)
    return lambda: session.run(None, feed)


def forest_job(forest: HorizonForest, view: View) -> Job:
    """Features and trees of the paper's forest, one thread."""
    above = view.elevation > 0
    return lambda: obstacle_map(measures(forest.p_above_samples(view), above).entropy, THRESHOLD)


def multiply_adds(net: HorizonFCN, camera: Camera) -> int:
    """Of one image of the camera's size, in the net's convolutions and the sampled last layer."""
    total = 0

    def count(layer: nn.Module, _: Any, output: Tensor) -> None:
        nonlocal total
        if isinstance(layer, nn.Conv2d):
            kernel = layer.kernel_size[0] * layer.kernel_size[1]
            total += output.numel() * kernel * layer.in_channels // layer.groups

    hooks = [layer.register_forward_hook(count) for layer in net.modules()]
    with torch.inference_mode():
        features = net.encode(torch.zeros(1, 3, camera.height, camera.width))
        logits = net.sample_logits(features)
    for hook in hooks:
        hook.remove()
    return total + logits.numel() * features.shape[1]


def convolution_rate(seconds: float = 0.4) -> float:
    """The best rate of multiply-adds a second that any of a few usual convolutions reaches, one thread."""
    best = 0.0
    for channels, rows, columns in ((32, 60, 80), (64, 60, 80), (128, 30, 40), (64, 120, 160)):
        layer = nn.Conv2d(channels, channels, 3, padding=1)
        stack = nn.Sequential(layer, nn.ReLU(), layer, nn.ReLU(), layer)
        job = exported_job(stack, (torch.rand(1, channels, rows, columns),), ["maps"])
        work = 3 * 9 * channels * channels * rows * columns
        end, shortest = time.perf_counter() + seconds, float("inf")
        while time.perf_counter() < end:
            start = time.process_time()
            job()
            shortest = min(shortest, time.process_time() - start)
        best = max(best, work / shortest)
    return best


def fresh_net(views: list[View]) -> HorizonFCN:
    """Default net, batch norm set by the pictures."""
    torch.manual_seed(0)
    net = build_net(Config().model).train()
    with torch.no_grad():
        for view in views * 3:
            net(image_tensor(view.image))
    return net.eval()


def rounds_of(quick: dict[str, Job], slow: dict[str, Job], rounds: int) -> dict[str, list[Taken]]:
    """Milliseconds of every run, of the processor and by the clock."""
    times: dict[str, list[Taken]] = {name: [] for name in (*quick, *slow)}
    for number in range(rounds + 1):  # the first round warms up
        for _ in range(QUICK_RUNS):
            for name, job in quick.items():
                _time(job, times[name], number > 0)
        for name, job in slow.items():
            _time(job, times[name], number > 0)
    return times


def _time(job: Job, times: list[Taken], counts: bool) -> None:
    clock, processor = time.perf_counter(), time.process_time()
    job()
    if counts:
        times.append((1e3 * (time.process_time() - processor), 1e3 * (time.perf_counter() - clock)))


def run(rounds: int) -> dict[str, Any]:
    """All figures, ready for JSON."""
    torch.set_num_threads(1)
    recording = open_recording(embedded_set())
    camera = recording.calibrated
    frames = [recording.read(index) for index in evenly(range(recording.length), FRAMES)]
    views = [make_view(frame, camera.width * camera.height) for frame in frames]
    net, forest = fresh_net(views), HorizonForest.fit(views, seed=0, n_jobs=1)
    feed = feed_of(frames[0])
    inputs = (torch.from_numpy(feed["image"]), torch.from_numpy(feed["up_cam"]))
    depth_input = torch.rand(1, 3, DEPTH_HEIGHT, DEPTH_WIDTH)
    quick = {
        "uncertain map": whole_way_job(net, camera, feed),
        "single pass": whole_way_job(net, camera, feed, sampled=False),
        "net alone": exported_job(Sampled(net), inputs[:1], ["image"]),
    }
    slow = {
        "net sampled 16 times, one batch": exported_job(Batch(net, camera), inputs, ["image", "up_cam"]),
        "net sampled 16 times, one by one": one_by_one_job(net, camera, feed),
        "net sampled 16 times, torch": naive_torch(net, views[0]),
        "forest": forest_job(forest, views[0]),
        "forest, exported": whole_way_job(forest, camera, feed),
        "depth network": exported_job(DepthNet(DEPTH_HEIGHT, DEPTH_WIDTH), (depth_input,), ["image"]),
    }
    work, rate = multiply_adds(net, camera), convolution_rate()
    times = rounds_of(quick, slow, rounds)
    rate = max(rate, convolution_rate())
    found: dict[str, Any] = {
        name: quartiles([taken for taken, _ in one])
        | {"clock_median_ms": quartiles([clock for _, clock in one])["median_ms"]}
        for name, one in times.items()
    }
    bound = 1e3 * work / rate
    found["convolution bound"] = {
        "median_ms": bound,
        "q1_ms": bound,
        "q3_ms": bound,
        "clock_median_ms": bound,
    }
    return {
        "schema": 1,
        "image_size": [camera.width, camera.height],
        "depth_network_input": [DEPTH_WIDTH, DEPTH_HEIGHT],
        "threads": 1,
        "rounds": rounds,
        "machine": {**machine(), "load_average": os.getloadavg()[0]},
        "versions": versions(),
        "net": {"parameters": parameter_count(net), "multiply_adds": work},
        "best_convolution_rate_per_s": rate,
        "times": found,
        "ratios": {name: ratio(found, name) for name in WANTED},
        "net_alone_over_bound": found["net alone"]["median_ms"] / bound,
        "forest_nodes": sum(tree.tree_.node_count for tree in forest.classifier.estimators_),
    }


def ratio(found: dict[str, Any], name: str) -> dict[str, Any]:
    """How many times as long a candidate takes as the uncertain map, or the other way round."""
    ours, theirs = found["uncertain map"]["median_ms"], found[name]["median_ms"]
    how, limit = WANTED[name]
    value = theirs / ours if how == "at least" else ours / theirs
    return {
        "ratio": value,
        "wanted": f"{how} {limit:g}",
        "met": value >= limit if how == "at least" else value <= limit,
    }


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, metavar="FILE")
    parser.add_argument("--rounds", type=int, default=8)
    options = parser.parse_args()
    figures = run(options.rounds)
    print(f"{figures['machine']['processor']}, 320x240, one thread, milliseconds")
    for name, one in figures["times"].items():
        line = f"{name:36} {one['median_ms']:9.2f}  ({one['q1_ms']:.2f}-{one['q3_ms']:.2f})"
        line += f"  by the clock {one['clock_median_ms']:.2f}"
        if name in figures["ratios"]:
            against = figures["ratios"][name]
            line += f"  ratio {against['ratio']:7.2f}, wanted {against['wanted']}"
        print(line)
    if options.out:
        write_json(options.out, figures)


if __name__ == "__main__":
    main()
