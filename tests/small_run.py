"""A quickly trained run on the toy set, shared by the tests of export and runtime."""

import tempfile
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F  # noqa: N812
from toy import write_toy_set

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.view import make_view
from horizon_dl.export.export import Exported, export_run, trained_camera
from horizon_dl.models.build import build_net
from horizon_dl.models.encoded import EncodedImage, image_tensor
from horizon_dl.models.fcn import enlarge
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.evidence import training_evidence
from horizon_dl.training.run_folder import Run, save_run
from horizon_dl.uncertainty.measures import binary_entropy

REAL_SETS = (
    "kitti/2011_09_26/2011_09_26_drive_0052_sync",
    "arena",
    "corridor",
    "hallway",
    "tum_sample",
    "euroc_sample",
)
SETTINGS = {
    "image": {"max_pixels": 5000},  # below the toy's 6912, so that the graph has to resize
    "model": {"samples": 12},
    "forest": {"training_pixels": 20_000},
}
STEPS = 60


@lru_cache(maxsize=1)
def toy_set() -> Path:
    return write_toy_set(Path(tempfile.mkdtemp()) / "set", frames=24)


@lru_cache(maxsize=1)
def small_run() -> Run:
    """Trained by a loop of its own: what is tested here does not depend on how the library trains."""
    config = Config.model_validate(SETTINGS)
    views = [make_view(frame, config.image.max_pixels) for frame in toy_frames()]
    recording = open_recording(toy_set())
    all_views = [make_view(recording.read(index), config.image.max_pixels) for index in range(24)]
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        net = build_net(config.model).train()
        optimiser = torch.optim.Adam(net.parameters(), 0.005)
        for step in range(STEPS):
            view = views[step % len(views)]
            label = torch.tensor(view.elevation > 0)[None, None].float()
            logits = enlarge(net(image_tensor(view.image)), label.shape[-2:])
            loss = F.binary_cross_entropy_with_logits(logits, label.expand_as(logits))
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
    net.eval()
    entropies = [binary_entropy(EncodedImage(net, view.image).samples().mean(axis=0)) for view in views]
    info = {
        "data": "set",
        "format": "images",
        "camera": asdict(open_recording(toy_set()).camera),
        "frames": len(views),
        "skipped": {},
        "train_s": 1.0,
        "threshold": float(np.percentile(entropies, 75)),
        "threshold_rule": "percentile-75",
        **training_evidence(net, all_views, config),
    }
    return Run(net, config, info)


@lru_cache(maxsize=1)
def small_run_folder() -> Path:
    folder = Path(tempfile.mkdtemp()) / "run"
    folder.mkdir()
    save_run(folder, small_run())
    return folder


@lru_cache(maxsize=1)
def small_export() -> Exported:
    return export_run(small_run(), trained_camera(small_run(), "run"), toy_frames())


@lru_cache(maxsize=1)
def model_file() -> Path:
    folder = Path(tempfile.mkdtemp())
    return small_export().write(folder)


@lru_cache(maxsize=1)
def toy_frames() -> tuple[Frame, ...]:
    recording = open_recording(toy_set())
    return tuple(recording.read(index) for index in (0, 5, 11))


def fresh_run(frames, max_pixels=76_800) -> Run:
    """An untrained net whose batch norm knows these frames and whose probabilities are spread."""
    config = Config.model_validate({"image": {"max_pixels": max_pixels}})
    torch.manual_seed(0)
    net = build_net(config.model).train()
    images = [image_tensor(make_view(frame, max_pixels).image) for frame in frames]
    with torch.no_grad():
        for image in images * 3:
            net(image)
        net.masks.mul_(20)
    net.eval()
    entropy = binary_entropy(EncodedImage(net, make_view(frames[0], max_pixels).image).samples().mean(axis=0))
    return Run(net, config, {"threshold": float(np.median(entropy))})
