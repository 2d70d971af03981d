"""The walls of a hall, a hallway or a yard, with doors and what hangs on them."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from horizon_dl.simulation.faces import Face, upright
from horizon_dl.simulation.layout import Arena
from horizon_dl.simulation.surfaces import (
    BOX_SURFACES,
    PALETTE,
    WALL_SURFACES,
    Texture,
    bricks,
    concrete,
    painted,
    plain,
    planks,
    plaster,
)

SKIRTING_M = 0.1


def wall_faces(rng: np.random.Generator, arena: Arena, textures: list[Texture]) -> Iterator[Face]:
    """What is seen of the walls; their pictures are added to the scene's."""
    kind = _stretches if arena.door_every_m is None else _hallway
    yield from kind(rng, arena, textures)


def _stretches(rng: np.random.Generator, arena: Arena, textures: list[Texture]) -> Iterator[Face]:
    """Four walls, each of two or three stretches of different material, with posters and doors."""
    for side in range(4):
        turn = side * np.pi / 2
        out = (arena.length_m if side % 2 == 0 else arena.width_m) / 2
        span = arena.width_m if side % 2 == 0 else arena.length_m
        cuts = np.array((0.0, *np.sort(rng.uniform(0.2, 0.8, rng.integers(1, 3))), 1.0)) * span - span / 2
        c, s = float(np.cos(turn)), float(np.sin(turn))
        for low, high in pairwise(cuts):
            centre, half = float(low + high) / 2, float(high - low) / 2
            textures.append(painted(rng, WALL_SURFACES, _wall_colour(rng, arena), (256, 512)))
            place = (c * out - s * centre, s * out + c * centre, arena.wall_m / 2)
            yield upright(place, turn + np.pi, (half, arena.wall_m / 2), len(textures) - 1)
            if rng.random() < 0.7 and half > 0.8:
                yield _hanging(rng, arena, textures, turn, out - 0.02, centre)


def _hallway(rng: np.random.Generator, arena: Arena, textures: list[Texture]) -> Iterator[Face]:
    """Four walls of one material with a skirting board, doors in the long ones, one thing at each end."""
    assert arena.door_every_m is not None
    wall, colour = _wall_colour(rng, arena), _any_colour(rng)
    first = len(textures)
    textures.append(painted(rng, (plain, plain, plaster, concrete, bricks), wall, (256, 512)))
    textures.append(painted(rng, (plain,), _any_colour(rng), (16, 256)))
    textures.append(painted(rng, (plain, planks, plaster), colour, (128, 128)))
    for side in range(4):
        turn = side * np.pi / 2
        long = side % 2 == 1
        out = (arena.width_m if long else arena.length_m) / 2
        half = (arena.length_m if long else arena.width_m) / 2
        c, s = float(np.cos(turn)), float(np.sin(turn))
        yield upright((c * out, s * out, arena.wall_m / 2), turn + np.pi, (half, arena.wall_m / 2), first)
        board = (c * (out - 0.01), s * (out - 0.01), SKIRTING_M / 2)
        yield upright(board, turn + np.pi, (half, SKIRTING_M / 2), first + 1)
        doors = np.arange(rng.uniform(0.6, arena.door_every_m) - half, half - 0.6, arena.door_every_m)
        for along in doors if long else rng.uniform(-0.3, 0.3, 1) * half:
            place = (c * (out - 0.02) - s * along, s * (out - 0.02) + c * along, 1.05)
            yield upright(place, turn + np.pi, (float(rng.uniform(0.4, 0.6)), 1.05), first + 2)
        if rng.random() < 0.7:
            yield _hanging(rng, arena, textures, turn, out - 0.03, float(rng.uniform(-0.8, 0.8)) * half)


def _hanging(
    rng: np.random.Generator, arena: Arena, textures: list[Texture], turn: float, out: float, along: float
) -> Face:
    """A poster on the wall, or a door that stands on the floor."""
    door = rng.random() < 0.4
    half = (0.5, 1.05) if door else (float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.3, 0.6)))
    height = half[1] if door else float(rng.uniform(1.2, arena.wall_m - 0.8))
    textures.append(painted(rng, BOX_SURFACES, _any_colour(rng), (128, 128)))
    c, s = float(np.cos(turn)), float(np.sin(turn))
    place = (c * out - s * along, s * out + c * along, height)
    return upright(place, turn + np.pi, half, len(textures) - 1)


def _any_colour(rng: np.random.Generator) -> str:
    return list(PALETTE)[rng.integers(len(PALETTE))]


def _wall_colour(rng: np.random.Generator, arena: Arena) -> str:
    if arena.wall_colours:
        return arena.wall_colours[rng.integers(len(arena.wall_colours))]
    return arena.floor_colours[rng.integers(3)] if rng.random() < 0.35 else _any_colour(rng)
