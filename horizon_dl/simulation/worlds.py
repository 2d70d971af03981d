"""Worlds to simulate: the arena, a cluttered room, a yard under the sun; each seed is another one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from horizon_dl.simulation import things
from horizon_dl.simulation.layout import FLOOR_COLOURS, Arena, at_a_wall, draw_arena, placed, with_solid
from horizon_dl.simulation.rig import DRONE, Rig, draw_rig
from horizon_dl.simulation.solid import Solid

Rng = np.random.Generator
Range = tuple[float, float]
Draws = Sequence[tuple[int, Callable[[Rng], Solid]]]
"""The largest number of each thing, and how it is drawn."""


@dataclass(frozen=True)
class World:
    """A kind of world, of those that `kinds` names.

    Attributes:
        draw: a hall or yard with what stands in it.
        rig: the camera that is carried through it.
    """

    draw: Callable[[Rng], Arena]
    rig: Callable[[Rng], Rig]


AT_WALLS: Draws = ((5, things.shelf), (3, things.workplace), (1, things.stairs), (2, things.low_boxes))
INDOORS: Draws = ((3, things.workplace), (3, things.chair), (3, things.low_boxes), (1, things.stairs))
OUTDOORS: Draws = (
    (3, things.car),
    (5, things.tree),
    (5, things.bush),
    (3, things.hedge),
    (2, things.bench),
    (3, things.post),
    (2, things.low_boxes),
    (1, things.stairs),
)


def draw_clutter(rng: Rng) -> Arena:
    """An office, laboratory or store of 8 to 13 m by 7 to 11 m: most in it is low."""
    arena = _empty(rng, (8, 13), (7, 11), (2.5, 3.4), ("carpets", "lino", "boards", "tiles"))
    for solid in _drawn(rng, AT_WALLS):
        arena = with_solid(arena, at_a_wall(rng, solid, arena))
    return _furnished(rng, arena, INDOORS)


def draw_outdoors(rng: Rng) -> Arena:
    """A yard, car park or garden of 18 to 28 m between house walls: grass, gravel or paving, and shadows."""
    yard = _empty(rng, (18, 28), (18, 28), (3.5, 7.0), ("grass", "gravel", "paving", "path"))
    sun_rad = (float(rng.uniform(0, 2 * np.pi)), float(np.deg2rad(rng.uniform(20, 65))))
    return _furnished(rng, replace(yard, open_sky=True, sun_rad=sun_rad), OUTDOORS)


def _empty(rng: Rng, length: Range, width: Range, wall: Range, grounds: Sequence[str]) -> Arena:
    length_m, width_m, wall_m = (float(rng.uniform(*bounds)) for bounds in (length, width, wall))
    colours = _floor_colours(rng)
    return Arena(length_m, width_m, wall_m, False, colours, (), grounds[int(rng.integers(len(grounds)))])


def _floor_colours(rng: Rng) -> tuple[str, str, str]:
    one, two, three = (str(name) for name in rng.choice(FLOOR_COLOURS, 3, replace=False))
    return (one, two, three)


def _drawn(rng: Rng, draws: Draws) -> list[Solid]:
    """Half to all of each kind of thing, in a random order."""
    wanted = [draw for most, draw in draws for _ in range(int(rng.integers(-(-most // 2), most + 1)))]
    return [wanted[index](rng) for index in rng.permutation(len(wanted))]


def _furnished(rng: Rng, arena: Arena, draws: Draws) -> Arena:
    for solid in _drawn(rng, draws):
        turned = replace(solid, turn_rad=float(rng.uniform(0, 2 * np.pi)))
        arena = with_solid(arena, placed(rng, turned, arena))
    return arena


def _drone(_: Rng) -> Rig:
    return DRONE


WORLDS = {
    "arena": World(draw_arena, _drone),
    "clutter": World(draw_clutter, draw_rig),
    "outdoor": World(draw_outdoors, draw_rig),
}
