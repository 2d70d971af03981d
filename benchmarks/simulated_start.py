"""Teaches the small net in simulated worlds what floor is: the weights that training starts from.

`python benchmarks/simulated_start.py --frames FOLDER` renders rooms full of furniture, hallways, yards and
streets, each of another seed, into a folder, trains the default net on the renderer's labels (floor against
everything else) and writes `horizon_dl/models/simulated_start.safetensors`: 20 and 25 minutes on a core. The
kinds arena, as the embedded set is one, and office take no part; nor do the seeds under 100, on which the
defaults are tried (these are 300 to 399). Light, colours, shade, sharpness and noise of the crops are drawn
at random, so that the net learns what real pictures share (domain randomisation, Tobin et al. 2017,
arXiv:1703.06907). Where the software renderer crashes, after some hundred worlds, start it again: it goes on.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import cast

import kornia.augmentation as augment
import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image
from safetensors.torch import save_file
from torch import nn

from horizon_dl.config import ModelConfig
from horizon_dl.data.frame import Truth
from horizon_dl.geometry.resize import area_resize, nearest
from horizon_dl.models.build import build_net
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import OWN, SIMULATED
from horizon_dl.progress import show_progress
from horizon_dl.simulation.shots import Conditions, draw_flight, render_flight
from horizon_dl.simulation.worlds import WORLDS
from horizon_dl.training.averaging import averaged
from horizon_dl.training.crops import TrainingFrame, draw_batch
from horizon_dl.training.loss import horizon_loss

FIRST_SEED = 300
KINDS = ("clutter", "hallway", "outdoor", "street")
FLIGHT_FRAMES, FIRST_FRAME, EVERY = 120, 6, 15
JPEG_QUALITY = 90
SIZES = ((320, 240), (320, 240), (224, 168), (176, 132))
"""Of the pictures that are kept, one after the other: things are learned nearer and farther."""
BATCH, CROP = 12, 128
LEARNING_RATE, WEIGHT_DECAY, AVERAGE_DECAY = 0.003, 0.0001, 0.99


def main() -> None:
    """Render, train, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--frames", type=Path, required=True, help="folder for the rendered frames")
    parser.add_argument("--worlds", type=int, default=100, help="of each kind")
    parser.add_argument("--steps", type=int, default=6000)
    parser.add_argument("--out", type=Path, default=SIMULATED)
    args = parser.parse_args()
    net = taught(list(training_frames(args.frames, args.worlds)), args.steps)
    learned = {name: value.contiguous() for name, value in net.state_dict().items() if name not in OWN}
    save_file(learned, args.out)


def training_frames(folder: Path, worlds: int) -> Iterator[TrainingFrame]:
    """Frames of so many worlds of each kind, in turn at each of the sizes; what is missing is rendered."""
    names = [(kind, seed) for seed in range(FIRST_SEED, FIRST_SEED + worlds) for kind in KINDS]
    for kind, seed in show_progress(names, what="rendering", unit="world"):
        world = folder / f"{kind}_{seed}"
        if not world.exists():
            render(world, kind, seed)
        for number, path in enumerate(sorted((world / "images").iterdir())):
            truth = np.asarray(Image.open(world / "labels" / f"{path.stem}.png"))
            yield frame_of(np.asarray(Image.open(path)), truth, SIZES[number % len(SIZES)])


def render(folder: Path, kind: str, seed: int) -> None:
    """Pictures and labels, spread over a flight through one world."""
    scene, rig, flight = draw_flight(WORLDS[kind], seed, FLIGHT_FRAMES)
    conditions = Conditions(seed=seed, frames=FLIGHT_FRAMES)
    only = set(range(FIRST_FRAME, FLIGHT_FRAMES, EVERY))
    part = folder.with_name(f"{folder.name}.part")
    for name in ("images", "labels"):
        (part / name).mkdir(parents=True, exist_ok=True)
    shots = render_flight(scene, rig, flight, conditions, SIZES[0], only=only)
    for number, shot in enumerate(shots):
        Image.fromarray(shot.image).save(part / "images" / f"{number:05d}.jpg", quality=JPEG_QUALITY)
        Image.fromarray(shot.truth).save(part / "labels" / f"{number:05d}.png")
    part.rename(folder)


def frame_of(image: NDArray[np.uint8], truth: NDArray[np.uint8], size: tuple[int, int]) -> TrainingFrame:
    """A picture at a size (width, height) with the target 0 for the floor and 1 for everything else."""
    small = nearest(truth, size[1], size[0])
    target = (small != Truth.FLOOR).astype(np.float16)
    return TrainingFrame(area_resize(image, size), target, small != Truth.IGNORE)


def taught(frames: Sequence[TrainingFrame], steps: int) -> HorizonFCN:
    """The default net after so many steps; the moving average of its weights."""
    rng = np.random.default_rng(0)
    torch.manual_seed(0)
    net, looks = build_net(ModelConfig()).train(), random_looks()
    average = averaged(net, AVERAGE_DECAY)
    optimiser = torch.optim.AdamW(net.parameters(), lr=LEARNING_RATE, weight_decay=WEIGHT_DECAY)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, LEARNING_RATE, total_steps=steps, pct_start=0.1)
    for _ in show_progress(range(steps), what="training", unit="step"):
        chosen = [frames[index] for index in rng.integers(len(frames), size=BATCH)]
        batch = draw_batch(chosen, CROP, rng)
        loss = horizon_loss(net(looks(batch.images)), batch)
        optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        optimiser.step()
        schedule.step()
        average.update_parameters(net)
    return cast(HorizonFCN, average.module)


def random_looks() -> nn.Module:
    """Other colours, light, shade, sharpness and noise for every crop; what is floor stays floor."""
    return nn.Sequential(
        augment.ColorJiggle(brightness=0.3, contrast=0.3, saturation=0.5, hue=0.5, p=0.9),
        augment.RandomChannelShuffle(p=0.3),
        augment.RandomGrayscale(p=0.25),
        augment.RandomGamma(gamma=(0.6, 1.6), p=0.7),
        augment.RandomPlasmaShadow(shade_intensity=(-0.6, -0.1), p=0.5),
        augment.RandomLinearIllumination(p=0.3),
        augment.RandomGaussianBlur((3, 3), (0.3, 1.2), p=0.3),
        augment.RandomGaussianNoise(std=0.03, p=0.6),
    )


if __name__ == "__main__":
    main()
