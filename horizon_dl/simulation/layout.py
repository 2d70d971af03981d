"""Where things stand in the arena: walls, boxes, panels, poles, mats; drawn by a seed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.simulation.surfaces import PALETTE

GAP_M = 1.5  # between any two solids, and from a solid to a wall: the flight has to fit through


FLOOR_COLOURS = ("green", "blue", "charcoal", "grey", "beige", "brown")


@dataclass(frozen=True)
class Solid:
    """An upright box or pole on the floor.

    Attributes:
        kind: `box`, `panel` or `pole`.
        x: metres, world x (north).
        y: metres, world y (west).
        turn_rad: rotation of a box about the vertical.
        half_x: half length in metres, or the radius of a pole.
        half_y: half width in metres, or the radius of a pole.
        height_m: metres above the floor.
        colour: name in `PALETTE`.
    """

    kind: str
    x: float
    y: float
    turn_rad: float
    half_x: float
    half_y: float
    height_m: float
    colour: str

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Horizontal distance in metres of points (N, 2) to the solid's outline; 0 inside."""
        offset = points - (self.x, self.y)
        if self.kind == "pole":
            return np.asarray(np.maximum(np.hypot(*offset.T) - self.half_x, 0))
        c, s = np.cos(self.turn_rad), np.sin(self.turn_rad)
        along = np.abs(offset @ (c, s)) - self.half_x
        across = np.abs(offset @ (-s, c)) - self.half_y
        return np.asarray(np.hypot(np.maximum(along, 0), np.maximum(across, 0)))

    @property
    def reach_m(self) -> float:
        """Radius of the circle round the outline."""
        return self.half_x if self.kind == "pole" else float(np.hypot(self.half_x, self.half_y))


@dataclass(frozen=True)
class Arena:
    """A rectangular hall or yard centred on the origin; x north, y west, z up, floor at z = 0."""

    length_m: float
    width_m: float
    wall_m: float
    open_sky: bool
    floor_colours: tuple[str, str, str]
    solids: tuple[Solid, ...]

    def clearance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Horizontal distance in metres of points (N, 2) to the nearest wall or solid; negative outside."""
        half = np.array((self.length_m / 2, self.width_m / 2))
        distances = [(half - np.abs(points)).min(axis=1), *(s.distance(points) for s in self.solids)]
        return np.asarray(np.min(distances, axis=0))


def _pick(rng: np.random.Generator, names: Sequence[str]) -> str:
    return names[int(rng.integers(len(names)))]


def _solid(rng: np.random.Generator, kind: str, colour: str) -> Solid:
    turn = float(rng.uniform(0, np.pi))
    if kind == "pole":
        radius, height = float(rng.uniform(0.08, 0.20)), float(rng.uniform(2.1, 3.0))
        return Solid(kind, 0, 0, 0, radius, radius, height, colour)
    if kind == "panel":
        half, height = float(rng.uniform(0.7, 1.5)), float(rng.uniform(1.9, 2.7))
        return Solid(kind, 0, 0, turn, half, 0.05, height, colour)
    half_x, half_y = (float(h) for h in rng.uniform(0.25, 0.6, 2))
    height = float(rng.uniform(1.1, 2.0) if kind == "box" else rng.uniform(0.4, 0.8))
    return Solid("box", 0, 0, turn, half_x, half_y, height, colour)


def _place(rng: np.random.Generator, solid: Solid, arena: Arena) -> Solid | None:
    half = np.array((arena.length_m / 2, arena.width_m / 2)) - 0.9 - solid.reach_m
    for _ in range(60):
        spot = rng.uniform(-half, half)
        apart = [float(s.distance(spot[None])[0]) - solid.reach_m for s in arena.solids]
        if min(apart, default=np.inf) > GAP_M:
            return Solid(**{**vars(solid), "x": float(spot[0]), "y": float(spot[1])})
    return None


def draw_arena(rng: np.random.Generator) -> Arena:
    """A random arena of 11 to 16 m by 10 to 14 m with up to 16 solids.

    One solid in three takes a colour of the floor, so that colour alone does not tell them apart.
    """
    names = list(PALETTE)
    floor = tuple(str(name) for name in rng.choice(FLOOR_COLOURS, 3, replace=False))
    arena = Arena(
        length_m=float(rng.uniform(11, 16)),
        width_m=float(rng.uniform(10, 14)),
        wall_m=float(rng.uniform(2.9, 4.0)),
        open_sky=bool(rng.random() < 0.3),
        floor_colours=(floor[0], floor[1], floor[2]),
        solids=(),
    )
    wanted = ["panel"] * 4 + ["box"] * 5 + ["pole"] * 5 + ["low box"] * 2
    for kind in wanted:
        colour = _pick(rng, floor if rng.random() < 0.35 else names)
        placed = _place(rng, _solid(rng, kind, colour), arena)
        if placed is not None:
            arena = Arena(**{**vars(arena), "solids": (*arena.solids, placed)})
    return arena
