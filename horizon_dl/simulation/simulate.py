"""Renders a flight through a random arena and writes it as a set in the images + CSV format."""

import csv
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image
from tqdm import tqdm

from horizon_dl.errors import InputError
from horizon_dl.simulation.flight import Flight, plan_flight
from horizon_dl.simulation.layout import draw_arena
from horizon_dl.simulation.pose import nudge, optical_axes
from horizon_dl.simulation.rendering import SceneRenderer
from horizon_dl.simulation.scene import build_scene
from horizon_dl.simulation.sensor import JITTER_PX, AutoExposure, develop, to_linear, vignette

Floats = NDArray[np.float64]

RATE_HZ = 6.0
LEAD_IN_S = 1.0  # hover at the start and end of the smoothed path is left out
FIELD_OF_VIEW_DEG = 75.0  # horizontal
MOUNT_RPY_DEG = (0.0, -9.0, 0.0)  # the camera looks 9 degrees down
COLUMNS = ("image", "time_s", "roll_rad", "pitch_rad", "yaw_rad", "height_m")


@dataclass(frozen=True)
class Shot:
    """One rendered frame: picture, labels, depth (metres) and the pose in the middle of the exposure."""

    image: NDArray[np.uint8]
    truth: NDArray[np.uint8]
    depth_m: Floats
    time_s: float
    place: Floats
    rpy_rad: Floats


def focal_length_px(width: int) -> float:
    """Focal length in pixels for the simulated field of view."""
    return float(width / 2 / np.tan(np.deg2rad(FIELD_OF_VIEW_DEG) / 2))


def camera_fields(width: int, height: int) -> dict[str, object]:
    """What `camera.yaml` says: an exact pinhole, pixel centres at integers."""
    focal = round(focal_length_px(width), 6)
    return {
        "model": "pinhole",
        "width": width,
        "height": height,
        "fx": focal,
        "fy": focal,
        "cx": (width - 1) / 2,
        "cy": (height - 1) / 2,
        "distortion": [0.0, 0.0, 0.0, 0.0, 0.0],
        "rotate_image": "none",
        "mount_rpy_deg": list(MOUNT_RPY_DEG),
    }


def _check(out: Path, frames: int, width: int, height: int, depth_every: int) -> None:
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(out, "exists already and is not an empty folder", "choose another --out or remove it")
    for name, value, low, high in (
        ("frames", frames, 2, 100_000),
        ("width", width, 64, 2048),
        ("height", height, 48, 2048),
        ("depth_every", depth_every, 1, 100_000),
    ):
        if not low <= value <= high:
            raise InputError("simulation", f"{name} is {value}", f"take one from {low} to {high}")


def _lamp_factors(rng: np.random.Generator, count: int) -> Floats:
    """Slow changes of each lamp, (count, 3): factors of about 0.5 to 1.5, one of them now and then low."""
    steps = np.arange(count)[:, None] / RATE_HZ
    period, phase = rng.uniform(6, 20, 3), rng.uniform(0, 2 * np.pi, 3)
    factors: Floats = 1 + rng.uniform(0.15, 0.45, 3) * np.sin(2 * np.pi * steps / period + phase)
    return factors


def _colour(renderer: SceneRenderer, flight: Flight, time_s: float, exposure_s: float, focal: float) -> Floats:
    """Mean light over the exposure; sub-pixel shifts smooth the edges."""
    pictures = []
    for index, shift in enumerate(JITTER_PX):
        place, rpy = flight.at(time_s + exposure_s * ((index + 0.5) / len(JITTER_PX) - 0.5))
        axes = nudge(optical_axes(rpy, np.deg2rad(MOUNT_RPY_DEG)), shift, focal)
        pictures.append(renderer.colour(place, axes))
    return to_linear(pictures)


def render_flight(frames: int, seed: int, width: int, height: int, only: set[int] | None = None) -> Iterator[Shot]:
    """Frames of the flight that a seed stands for, in time order.

    Labels and depth belong to the surface at the pixel's centre in the middle of the exposure.

    Args:
        frames: length of the flight in frames; a longer one is another flight.
        seed: of arena, materials, path, light and noise.
        width: pixels.
        height: pixels.
        only: render these indices alone; their labels and depth are those of the whole flight, their
            exposure is not.
    """
    world, path, light = (np.random.default_rng((seed, stream)) for stream in range(3))
    arena = draw_arena(world)
    flight = plan_flight(path, arena, 2 * LEAD_IN_S + frames / RATE_HZ)
    lamps, noise = _lamp_factors(light, frames), float(light.uniform(0.7, 1.1))
    exposure, focal = AutoExposure(gain=float(light.uniform(0.9, 1.6))), focal_length_px(width)
    dim, tints = vignette(height, width), light.uniform(-0.06, 0.06, (2, 3))
    with SceneRenderer(build_scene(world, arena), width, height, focal) as renderer:
        for index in range(frames):
            if only is not None and index not in only:
                continue
            time_s = LEAD_IN_S + index / RATE_HZ
            renderer.set_lamps(lamps[index])
            place, rpy = flight.at(time_s)
            truth, depth = renderer.truth(place, optical_axes(rpy, np.deg2rad(MOUNT_RPY_DEG)))
            linear = _colour(renderer, flight, time_s, exposure.exposure_s, focal) * dim
            balance = 1 + tints[0] + tints[1] * np.sin(2 * np.pi * index / frames)
            image = develop(np.random.default_rng((seed, 3, index)), linear, exposure.gain, balance, noise)
            exposure.follow(float(linear.mean()))
            yield Shot(image, truth, depth, time_s, place, rpy)


def _row(name: str, shot: Shot) -> tuple[object, ...]:
    roll, pitch, yaw = (float(angle) for angle in shot.rpy_rad)
    yaw = float((yaw + np.pi) % (2 * np.pi) - np.pi)
    numbers = (shot.time_s, roll, pitch, yaw, float(shot.place[2]))
    return (name, *(f"{number:.6f}" for number in numbers))


def _write(folder: Path, index: int, shot: Shot, quality: int, with_depth: bool) -> str:
    stem = f"{index:05d}"
    Image.fromarray(shot.image).save(folder / "images" / f"{stem}.jpg", quality=quality)
    Image.fromarray(shot.truth).save(folder / "labels" / f"{stem}.png")
    if with_depth:
        millimetres = np.clip(shot.depth_m * 1000 + 0.5, 0, 65535).astype(np.uint16)
        Image.fromarray(millimetres).save(folder / "depth" / f"{stem}.png")
    return f"images/{stem}.jpg"


def simulate(
    out: Path,
    *,
    frames: int,
    seed: int,
    width: int = 320,
    height: int = 240,
    depth_every: int = 1,
    quality: int = 85,
    progress: bool = False,
) -> None:
    """Renders a set: `images`, `frames.csv`, `camera.yaml`, `labels` and `depth`.

    Args:
        out: folder to make; it must not exist or be empty. It appears when everything is written.
        frames: how many, at 6 a second.
        seed: another seed is another arena, other materials, another flight.
        width: pixels.
        height: pixels.
        depth_every: depth for every n-th frame, from frame n // 2 on.
        quality: of the JPEG files, 1 to 95.
        progress: show a bar.

    Raises:
        InputError: `out` is taken, a number is out of range, or rendering is not possible here.
    """
    _check(out, frames, width, height, depth_every)
    beside = out.with_name(out.name + ".partial")
    shutil.rmtree(beside, ignore_errors=True)
    try:
        for part in ("images", "labels", "depth"):
            (beside / part).mkdir(parents=True)
        rows = []
        shots = tqdm(render_flight(frames, seed, width, height), total=frames, unit="frame", disable=not progress)
        for index, shot in enumerate(shots):
            name = _write(beside, index, shot, quality, index % depth_every == depth_every // 2)
            rows.append(_row(name, shot))
        with (beside / "frames.csv").open("w", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows((COLUMNS, *rows))
        (beside / "camera.yaml").write_text(yaml.safe_dump(camera_fields(width, height), sort_keys=False))
        if out.exists():
            out.rmdir()
        beside.rename(out)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
