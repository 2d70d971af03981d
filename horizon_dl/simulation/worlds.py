"""Worlds to simulate: halls, rooms, hallways, offices, yards and streets; each seed is another one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from horizon_dl.simulation import office, things
from horizon_dl.simulation.layout import (
    AISLE_M,
    CROWDED_GAP_M,
    FLOOR_COLOURS,
    GAP_M,
    PAVEMENT_SHARE,
    Arena,
    at_a_wall,
    beside_the_way,
    draw_arena,
    placed,
    with_solid,
)
from horizon_dl.simulation.office import muted
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
IN_A_HALLWAY: Draws = (
    (4, things.cabinet),
    (3, things.chairs),
    (3, things.trolley),
    (2, things.pillar),
    (2, things.open_door),
    (3, things.waste_bin),
    (2, things.shelf),
    (2, things.low_boxes),
)
AT_OFFICE_WALLS: Draws = (
    (4, muted(office.desks)),
    (3, muted(things.shelf)),
    (3, muted(things.cabinet)),
    (2, muted(things.waste_bin)),
    (2, muted(office.clutter)),
)
IN_AN_OFFICE: Draws = ((3, muted(office.desk_island)), (2, muted(office.desks)), (1, things.person))
ABOUT_AN_OFFICE: Draws = (
    (5, muted(office.office_chair)),
    (4, muted(office.clutter)),
    (2, muted(things.waste_bin)),
)
OFFICE_WALLS, OFFICE_FLOORS = ("white", "white", "grey", "beige"), ("grey", "charcoal", "beige")
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
ON_A_PAVEMENT: Draws = (
    (5, things.tree),
    (5, things.person),
    (4, things.post),
    (3, things.waste_bin),
    (2, things.hedge),
    (2, things.bench),
    (2, things.bush),
    (2, things.low_boxes),
)
PARKED, CROSSING = 9, 2
"""The most cars at the kerbs, and the most people on the road."""


def draw_clutter(rng: Rng) -> Arena:
    """An office, laboratory or store of 8 to 13 m by 7 to 11 m: most in it is low."""
    arena = _empty(rng, (8, 13), (7, 11), (2.5, 3.4), ("carpets", "lino", "boards", "tiles"))
    return _furnished(rng, _at_walls(rng, arena, AT_WALLS), INDOORS)


def draw_hallway(rng: Rng) -> Arena:
    """A hallway of 14 to 28 m by 3.6 to 5.5 m whose things stand at its walls; most floors shine."""
    hallway = _empty(rng, (14, 28), (3.6, 5.5), (2.4, 3.2), ("lino", "lino", "tiles", "boards", "carpets"))
    shine = float(rng.uniform(0.03, 0.35)) if rng.random() < 0.75 else 0.0
    arena = replace(hallway, door_every_m=float(rng.uniform(2.2, 5.0)), shine=shine)
    return _at_walls(rng, arena, IN_A_HALLWAY)


def draw_office(rng: Rng) -> Arena:
    """An office or laboratory of 8 to 14 m by 7 to 11 m, crowded and most of it white, grey and black."""
    room = _empty(rng, (8, 14), (7, 11), (2.4, 3.2), ("carpets", "lino", "lino", "tiles", "boards"))
    arena = replace(room, wall_colours=OFFICE_WALLS, door_every_m=float(rng.uniform(3.0, 9.0)))
    if rng.random() < 0.6:
        arena = replace(arena, floor_colours=_floor_colours(rng, OFFICE_FLOORS))
    arena = _furnished(rng, arena, IN_AN_OFFICE, AISLE_M)
    arena = _at_walls(rng, arena, AT_OFFICE_WALLS)
    return _furnished(rng, arena, ABOUT_AN_OFFICE, CROWDED_GAP_M)


def draw_outdoors(rng: Rng) -> Arena:
    """A yard, car park or garden of 18 to 28 m between house walls: grass, gravel or paving, and shadows."""
    yard = _empty(rng, (18, 28), (18, 28), (3.5, 7.0), ("grass", "gravel", "paving", "path"))
    return _furnished(rng, replace(yard, open_sky=True, sun_rad=_sun(rng)), OUTDOORS)


def draw_street(rng: Rng) -> Arena:
    """A street of 28 to 45 m by 12 to 17 m between house walls; its cars stand at the kerb."""
    empty = _empty(rng, (28, 45), (12, 17), (3.0, 8.0), ("street",))
    street = replace(empty, open_sky=True, sun_rad=_sun(rng))
    pavement_m = PAVEMENT_SHARE * street.width_m
    for _ in range(int(rng.integers(2, PARKED + 1))):
        car = things.car(rng)
        street = with_solid(street, beside_the_way(rng, car, street, pavement_m + car.half_y + 0.1))
    for solid in _drawn(rng, ON_A_PAVEMENT):
        from_wall_m = float(rng.uniform(min(solid.half_x, solid.half_y) + 0.1, pavement_m))
        street = with_solid(street, beside_the_way(rng, solid, street, from_wall_m))
    return _furnished(rng, street, ((CROSSING, things.person),))


def _sun(rng: Rng) -> tuple[float, float]:
    return (float(rng.uniform(0, 2 * np.pi)), float(np.deg2rad(rng.uniform(20, 65))))


def _empty(rng: Rng, length: Range, width: Range, wall: Range, grounds: Sequence[str]) -> Arena:
    length_m, width_m, wall_m = (float(rng.uniform(*bounds)) for bounds in (length, width, wall))
    colours = _floor_colours(rng)
    return Arena(length_m, width_m, wall_m, False, colours, (), grounds[int(rng.integers(len(grounds)))])


def _floor_colours(rng: Rng, names: Sequence[str] = FLOOR_COLOURS) -> tuple[str, str, str]:
    one, two, three = (str(name) for name in rng.choice(names, 3, replace=False))
    return (one, two, three)


def _drawn(rng: Rng, draws: Draws) -> list[Solid]:
    """Half to all of each kind of thing, in a random order."""
    wanted = [draw for most, draw in draws for _ in range(int(rng.integers(-(-most // 2), most + 1)))]
    return [wanted[index](rng) for index in rng.permutation(len(wanted))]


def _at_walls(rng: Rng, arena: Arena, draws: Draws) -> Arena:
    for solid in _drawn(rng, draws):
        arena = with_solid(arena, at_a_wall(rng, solid, arena))
    return arena


def _furnished(rng: Rng, arena: Arena, draws: Draws, gap_m: float = GAP_M) -> Arena:
    for solid in _drawn(rng, draws):
        turned = replace(solid, turn_rad=float(rng.uniform(0, 2 * np.pi)))
        arena = with_solid(arena, placed(rng, turned, arena, gap_m))
    return arena


def _drone(_: Rng) -> Rig:
    return DRONE


WORLDS = {
    "arena": World(draw_arena, _drone),
    "clutter": World(draw_clutter, draw_rig),
    "hallway": World(draw_hallway, draw_rig),
    "office": World(draw_office, draw_rig),
    "outdoor": World(draw_outdoors, draw_rig),
    "street": World(draw_street, draw_rig),
}
