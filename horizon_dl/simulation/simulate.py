"""Writes a simulated flight as a set in the images + CSV format."""

import csv
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import yaml
from PIL import Image

from horizon_dl.errors import InputError
from horizon_dl.output import output_folder
from horizon_dl.progress import show_progress
from horizon_dl.simulation.rig import Rig
from horizon_dl.simulation.shots import Conditions, Shot, draw_flight, render_flight
from horizon_dl.simulation.worlds import WORLDS

COLUMNS = ("image", "time_s", "roll_rad", "pitch_rad", "yaw_rad", "height_m")


def camera_fields(rig: Rig, width: int, height: int) -> dict[str, object]:
    """What `camera.yaml` says: an exact pinhole, pixel centres at integers."""
    return {
        "model": "pinhole",
        "width": width,
        "height": height,
        "fx": rig.focal_length_px(width),
        "fy": rig.focal_length_px(width),
        "cx": (width - 1) / 2,
        "cy": (height - 1) / 2,
        "distortion": [],
        "mount_rpy_deg": list(rig.mount_rpy_deg),
    }


def _check(out: Path, **numbers: tuple[int, int, int]) -> None:
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(out, "is not an empty folder", "give another --out or remove it")
    for name, (value, low, high) in numbers.items():
        if not low <= value <= high:
            raise InputError("simulation", f"{name} is {value}", f"take one from {low} to {high}")


def _row(name: str, shot: Shot) -> tuple[str, ...]:
    roll, pitch, yaw = shot.rpy_rad
    yaw = (yaw + np.pi) % (2 * np.pi) - np.pi
    return (name, *(f"{float(number):.6f}" for number in (shot.time_s, roll, pitch, yaw, shot.place[2])))


def _write_shot(folder: Path, index: int, shot: Shot, quality: int, with_depth: bool) -> str:
    stem = f"{index:05d}"
    Image.fromarray(shot.image).save(folder / "images" / f"{stem}.jpg", quality=quality)
    Image.fromarray(shot.truth).save(folder / "labels" / f"{stem}.png")
    if with_depth:
        millimetres = np.clip(shot.depth_m * 1000 + 0.5, 0, 65535).astype(np.uint16)
        Image.fromarray(millimetres).save(folder / "depth" / f"{stem}.png")
    return f"images/{stem}.jpg"


def _write_set(folder: Path, shots: Iterable[Shot], depth_every: int, quality: int) -> None:
    for part in ("images", "labels", "depth"):
        (folder / part).mkdir()
    rows = []
    for index, shot in enumerate(shots):
        with_depth = index % depth_every == depth_every // 2
        rows.append(_row(_write_shot(folder, index, shot, quality, with_depth), shot))
    with (folder / "frames.csv").open("w", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows((COLUMNS, *rows))


def simulate(
    out: Path,
    *,
    frames: int,
    seed: int,
    world: str = "arena",
    width: int = 320,
    height: int = 240,
    depth_every: int = 1,
    quality: int = 85,
    progress: bool = False,
) -> None:
    """Renders a flight through a random world: `images`, `frames.csv`, `camera.yaml`, `labels`, `depth`.

    Labels (values of `Truth`) and depth (uint16, millimetres along the optical axis, 0 = none) belong to the
    surface at the pixel's centre in the middle of the exposure, which is the time and attitude in
    `frames.csv`. No pixel is ignored, not even on edges: a margin would swallow the thin far poles and the
    ground contact that ranging is measured by, and motion blur is wider than any fixed margin.

    Args:
        out: folder to make; it must not exist or be empty. It appears when everything is written.
        frames: how many, at 6 a second.
        seed: another seed is another world of its kind, other materials, another flight.
        world: a name in `WORLDS`.
        width: pixels.
        height: pixels.
        depth_every: depth for every n-th frame, from frame n // 2 on.
        quality: of the JPEG files, 1 to 95.
        progress: show a bar.

    Raises:
        InputError: `out` is taken, a number is out of range, or rendering is not possible here.
    """
    _check(
        out,
        frames=(frames, 2, 100_000),
        seed=(seed, 0, 2**32 - 1),
        width=(width, 64, 2048),
        height=(height, 48, 2048),
        depth_every=(depth_every, 1, 100_000),
        quality=(quality, 1, 95),
    )
    if world not in WORLDS:
        raise InputError("simulation", f"there is no world {world!r}", f"take one of {', '.join(WORLDS)}")
    scene, rig, flight = draw_flight(WORLDS[world], seed, frames)
    shots = render_flight(scene, rig, flight, Conditions(seed, frames), (width, height))
    try:
        with output_folder(out, "simulate") as folder:
            bar = show_progress(shots, "rendering", total=frames, unit="frame", disable=not progress)
            _write_set(folder, bar, depth_every, quality)
            (folder / "camera.yaml").write_text(
                yaml.safe_dump(camera_fields(rig, width, height), sort_keys=False)
            )
    except OSError as error:
        raise InputError(
            out, f"cannot be written ({error.strerror})", "free space or give another --out"
        ) from None
