"""An online run so small that a test may do dozens of them."""

import json
from pathlib import Path

from safetensors.torch import load_file

from horizon_dl.config import Config, load_config
from horizon_dl.online.run import OnlineRun
from horizon_dl.online.run_directory import CHECKPOINT
from horizon_dl.readers.registry import open_recording

TINY = {
    "model.channels": "4",
    "model.samples": "4",
    "image.max_pixels": "1728",
    "online.crop": "32",
    "online.batch": "3",
    "online.steps_per_frame": "2",
    "online.warm_up_steps": "2",
    "online.warm_up_frames": "3",
    "online.memory_mb": "0.02",
    "online.checkpoint_frames": "3",
}
TIMES = ("predict_ms", "learn_ms", "frames_per_s")


def tiny_options(**more: str) -> list[str]:
    """For the command line."""
    return [word for key, value in {**TINY, **more}.items() for word in (f"--{key}", value)]


def tiny_config(*overrides: str) -> Config:
    return load_config(None, [*(f"{key}={value}" for key, value in TINY.items()), *overrides])


def tiny_run(data: Path, out: Path, *overrides: str, **options) -> OnlineRun:
    return OnlineRun(open_recording(data), tiny_config(*overrides), out, **options)


def frame_lines(out: Path) -> list[dict]:
    """The frames' lines without what a clock measured."""
    lines = [json.loads(line) for line in (out / "frames.jsonl").read_text().splitlines()]
    return [{key: value for key, value in line.items() if key not in TIMES} for line in lines]


def assert_same_run(one: Path, other: Path) -> None:
    """Weights, replay, optimiser, random states, accumulators and lines of two runs are equal to the bit."""
    first, second = (load_file(run / CHECKPOINT) for run in (one, other))
    assert first.keys() == second.keys()
    for name, tensor in first.items():
        assert tensor.equal(second[name]), name
    assert frame_lines(one) == frame_lines(other)
    assert figures(one) == figures(other)
    weights = [load_file(run / "weights.safetensors") for run in (one, other)]
    assert all(tensor.equal(weights[1][name]) for name, tensor in weights[0].items())


def figures(out: Path) -> dict:
    """The net's block of the metrics without what a clock measured."""
    block = json.loads((out / "metrics.json").read_text())["methods"]["cnn"]
    return {key: value for key, value in block.items() if key not in ("train_s", "predict_ms_per_frame")}
