"""Where things stand in a hall or yard, and the arena's boxes, panels and poles; drawn by a seed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.simulation.solid import Solid
from horizon_dl.simulation.surfaces import PALETTE

GAP_M = 1.5  # between things that stand free, unless they may crowd: the flight has to fit through
FREE_OF_WALLS_M = 0.9

PAVEMENT_SHARE = 0.18  # of a street's width, on each side
BESIDE_GAP_M = 0.3  # between things beside a street
CROWDED_GAP_M = 0.2  # from what stands about in an office to the furniture
AISLE_M = 0.8  # between free-standing desks
WALL_GAP_M = 0.05  # from furniture to the wall that it stands at
FLOOR_COLOURS = ("green", "blue", "charcoal", "grey", "beige", "brown")


@dataclass(frozen=True)
class Arena:
    """A rectangular hall or yard centred on the origin; x north, y west, z up, floor at z = 0.

    Attributes:
        length_m: along x.
        width_m: along y.
        wall_m: height of the walls.
        open_sky: no ceiling.
        floor_colours: of its materials.
        solids: what stands on the floor.
        ground: name of the floor's material, see `floor`.
        sun_rad: azimuth (from x towards y) and height of the sun, which casts shadows; None: lamps.
        wall_colours: of which the walls have one; empty: any.
        door_every_m: the long walls are of one material, with doors at this distance; None: of stretches.
        shine: share of the light that the floor reflects as a mirror, in [0, 1).
    """

    length_m: float
    width_m: float
    wall_m: float
    open_sky: bool
    floor_colours: tuple[str, str, str]
    solids: tuple[Solid, ...]
    ground: str = "carpets"
    sun_rad: tuple[float, float] | None = None
    wall_colours: tuple[str, ...] = ()
    door_every_m: float | None = None
    shine: float = 0.0

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


def placed(rng: np.random.Generator, solid: Solid, arena: Arena, gap_m: float = GAP_M) -> Solid | None:
    """The solid somewhere free, a gap from all others; None if there is no room."""
    half = np.array((arena.length_m / 2, arena.width_m / 2)) - FREE_OF_WALLS_M - solid.reach_m
    if half.min() <= 0:
        return None
    for _ in range(60):
        spot = rng.uniform(-half, half)
        apart = [float(s.distance(spot[None])[0]) - solid.reach_m for s in arena.solids]
        if min(apart, default=np.inf) > gap_m:
            return replace(solid, x=float(spot[0]), y=float(spot[1]))
    return None


def at_a_wall(rng: np.random.Generator, solid: Solid, arena: Arena) -> Solid | None:
    """The solid with its back (-x) at a wall, apart from all others; None if there is no room."""
    for _ in range(60):
        side = int(rng.integers(4))
        out, span = (arena.length_m, arena.width_m) if side % 2 == 0 else (arena.width_m, arena.length_m)
        if span / 2 <= WALL_GAP_M + solid.half_y:
            continue
        inwards = side * np.pi / 2 + np.pi
        c, s = -np.cos(inwards), -np.sin(inwards)
        away = out / 2 - WALL_GAP_M - solid.half_x
        along = float(rng.uniform(-1, 1)) * (span / 2 - WALL_GAP_M - solid.half_y)
        spot = np.array((c * away - s * along, s * away + c * along))
        apart = [float(other.distance(spot[None])[0]) - solid.reach_m for other in arena.solids]
        if min(apart, default=np.inf) > 2 * WALL_GAP_M:
            return replace(solid, x=float(spot[0]), y=float(spot[1]), turn_rad=float(inwards))
    return None


def beside_the_way(rng: np.random.Generator, solid: Solid, arena: Arena, from_wall_m: float) -> Solid | None:
    """The solid at a distance from a long wall, its longer side along it; None if there is no room."""
    half = arena.length_m / 2 - solid.reach_m - WALL_GAP_M
    for _ in range(60):
        spot = np.array((rng.uniform(-half, half), rng.choice((-1, 1)) * (arena.width_m / 2 - from_wall_m)))
        apart = [float(other.distance(spot[None])[0]) - solid.reach_m for other in arena.solids]
        if min(apart, default=np.inf) > BESIDE_GAP_M:
            turn = float(np.pi * (rng.integers(2) + 0.5 * (solid.half_y > solid.half_x)))
            return replace(solid, x=float(spot[0]), y=float(spot[1]), turn_rad=turn)
    return None


def with_solid(arena: Arena, solid: Solid | None) -> Arena:
    """The arena and one thing more, where there was room for it."""
    return arena if solid is None else replace(arena, solids=(*arena.solids, solid))


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
        arena = with_solid(arena, placed(rng, _solid(rng, kind, colour), arena))
    return arena
