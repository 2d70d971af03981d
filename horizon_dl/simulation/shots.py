"""Frames of a simulated flight: pictures as a small camera would take them, labels, depth, pose."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from horizon_dl.simulation.flight import Flight, fitting_flight
from horizon_dl.simulation.pose import nudge, optical_axes
from horizon_dl.simulation.rendering import SceneRenderer
from horizon_dl.simulation.rig import Rig
from horizon_dl.simulation.scene import Scene, build_scene
from horizon_dl.simulation.sensor import JITTER_PX, AutoExposure, Light, develop, to_linear, vignette
from horizon_dl.simulation.worlds import World

Floats = NDArray[np.float64]

RATE_HZ = 6.0
LEAD_IN_S = 1.0  # the ends of the smoothed path are left out


@dataclass(frozen=True)
class Shot:
    """One frame.

    Attributes:
        image: (h, w, 3) uint8 RGB.
        truth: (h, w) uint8 of `Truth`: the surface at the pixel's centre in the middle of the exposure.
        depth_m: (h, w) metres along the optical axis to that surface, 0 for the sky.
        time_s: seconds, the middle of the exposure.
        place: (3,) metres in the world, x north, y west, z up.
        rpy_rad: (3,) roll, pitch, yaw of the body (forward, right, down) in north-east-down.
    """

    image: NDArray[np.uint8]
    truth: NDArray[np.uint8]
    depth_m: Floats
    time_s: float
    place: Floats
    rpy_rad: Floats


@dataclass
class Conditions:
    """Light and camera during one flight, drawn by a seed."""

    seed: int
    frames: int
    noise: float = field(init=False)
    exposure: AutoExposure = field(init=False)

    def __post_init__(self) -> None:
        rng = np.random.default_rng((self.seed, 2))
        self._period_s, self._phase = rng.uniform(6, 20, 3), rng.uniform(0, 2 * np.pi, 3)
        self._swing = rng.uniform(0.15, 0.45, 3)
        self.noise = float(rng.uniform(0.7, 1.1))
        self.exposure = AutoExposure(gain=float(rng.uniform(0.9, 1.6)))
        self._tint, self._drift = rng.uniform(-0.06, 0.06, (2, 3))

    def lamps(self, index: int) -> Floats:
        """Brightness of the three lamps at a frame, factors of about 0.5 to 1.5 that change slowly."""
        time_s = index / RATE_HZ
        return np.asarray(1 + self._swing * np.sin(2 * np.pi * time_s / self._period_s + self._phase))

    def develop(self, linear: Light, index: int) -> NDArray[np.uint8]:
        """Light to the picture of a frame; the exposure follows."""
        balance = 1 + self._tint + self._drift * np.sin(2 * np.pi * index / self.frames)
        rng = np.random.default_rng((self.seed, 3, index))
        image = develop(rng, linear, self.exposure.gain, balance, self.noise)
        self.exposure.follow(float(linear.mean()))
        return image


def _expose(
    renderer: SceneRenderer,
    flight: Flight,
    time_s: float,
    exposure_s: float,
    mount_rpy_rad: Floats,
    focal_px: float,
) -> Light:
    """Mean light over the exposure; sub-pixel shifts smooth the edges."""
    pictures = []
    for index, shift in enumerate(JITTER_PX):
        place, rpy = flight.at(time_s + exposure_s * ((index + 0.5) / len(JITTER_PX) - 0.5))
        axes = nudge(optical_axes(rpy, mount_rpy_rad), shift, focal_px)
        pictures.append(renderer.colour(place, axes))
    return to_linear(pictures)


def draw_flight(kind: World, seed: int, frames: int) -> tuple[Scene, Rig, Flight]:
    """What a seed stands for: a scene, the camera in it, and its way through."""
    world, path, carried = (np.random.default_rng((seed, stream)) for stream in (0, 1, 4))
    rig = kind.rig(carried)
    arena, flight = fitting_flight(path, kind.draw(world), 2 * LEAD_IN_S + frames / RATE_HZ, rig.height_m)
    return build_scene(world, arena), rig, flight


def render_flight(
    scene: Scene,
    rig: Rig,
    flight: Flight,
    conditions: Conditions,
    size: tuple[int, int],
    only: set[int] | None = None,
) -> Iterator[Shot]:
    """Frames of a flight, in time order.

    Args:
        scene: flown through.
        rig: the camera.
        flight: its way, see `draw_flight`.
        conditions: light and sensor, and how many frames; they are used up.
        size: width and height, pixels.
        only: render these indices alone; their labels, depth and pose are those of the whole flight, their
            exposure is not.

    Raises:
        InputError: rendering is not possible on this machine.
    """
    width, height = size
    focal_px, mount = rig.focal_length_px(width), np.deg2rad(rig.mount_rpy_deg)
    dim, exposure = vignette(height, width), conditions.exposure
    with SceneRenderer(scene, width, height, focal_px) as renderer:
        for index in sorted(only) if only is not None else range(conditions.frames):
            time_s = LEAD_IN_S + index / RATE_HZ
            renderer.set_lamps(conditions.lamps(index))
            place, rpy = flight.at(time_s)
            truth, depth_m = renderer.truth(place, optical_axes(rpy, mount))
            linear = _expose(renderer, flight, time_s, exposure.exposure_s, mount, focal_px) * dim
            yield Shot(conditions.develop(linear, index), truth, depth_m, time_s, place, rpy)
