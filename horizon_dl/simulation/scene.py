"""A world as flat textured faces and cylinders, and as a MuJoCo model description (MJCF)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Truth
from horizon_dl.simulation.floor import paint_ceiling, paint_floor
from horizon_dl.simulation.layout import Arena
from horizon_dl.simulation.solid import Part, Solid
from horizon_dl.simulation.surfaces import (
    BOX_SURFACES,
    PALETTE,
    PANEL_SURFACES,
    SURFACES,
    WALL_SURFACES,
    Painter,
    Texture,
    to_texture,
)

Vector = tuple[float, float, float]
UP: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Face:
    """A textured rectangle, visible from the side of its normal.

    Attributes:
        centre: metres, world (x north, y west, z up).
        right: unit vector, the picture's right.
        up: unit vector, the picture's up.
        half_m: half width and half height in metres.
        texture: index into the scene's textures.
        truth: what its pixels are labelled.
    """

    centre: Vector
    right: Vector
    up: Vector
    half_m: tuple[float, float]
    texture: int
    truth: Truth


@dataclass(frozen=True)
class Tube:
    """A piece of a pole: an upright cylinder of one colour, always an obstacle."""

    centre: Vector
    radius_m: float
    half_height_m: float
    colour: Vector


@dataclass(frozen=True)
class Scene:
    """What the renderer needs of an arena."""

    arena: Arena
    faces: tuple[Face, ...]
    tubes: tuple[Tube, ...]
    textures: tuple[Texture, ...]


def _upright(centre: Vector, turn_rad: float, half: tuple[float, float], texture: int) -> Face:
    """An upright face whose normal points to `turn_rad` from +x towards +y."""
    right = (-float(np.sin(turn_rad)), float(np.cos(turn_rad)), 0.0)
    return Face(centre, right, UP, half, texture, Truth.OBSTACLE)


def _box_faces(solid: Solid, texture: int) -> Iterator[Face]:
    """Sides and top of a box on the floor."""
    yield from _cuboid_faces(solid, solid.bodies[0], texture)


def _cuboid_faces(solid: Solid, part: Part, texture: int) -> Iterator[Face]:
    """Sides and top of a part, and its underside where it does not stand on the floor."""
    c, s = float(np.cos(solid.turn_rad)), float(np.sin(solid.turn_rad))
    x, y = solid.place(part)
    middle, half_height = (part.low_m + part.high_m) / 2, (part.high_m - part.low_m) / 2
    sides = ((c, s, part.half_x, part.half_y), (-s, c, part.half_y, part.half_x))
    for number, (nx, ny, out, half) in enumerate(sides):
        turn = solid.turn_rad + number * np.pi / 2
        for sign, angle in ((1, turn), (-1, turn + np.pi)):
            yield _upright(
                (x + sign * nx * out, y + sign * ny * out, middle), angle, (half, half_height), texture
            )
    flat, along, across = (part.half_x, part.half_y), (c, s, 0.0), (-s, c, 0.0)
    yield Face((x, y, part.high_m), along, across, flat, texture, Truth.OBSTACLE)
    if part.low_m > 0:
        under = (part.half_y, part.half_x)
        yield Face((x, y, part.low_m), across, along, under, texture, Truth.OBSTACLE)


def _part_tube(solid: Solid, part: Part) -> Tube:
    x, y = solid.place(part)
    half = (part.high_m - part.low_m) / 2
    return Tube((x, y, part.low_m + half), part.half_x, half, PALETTE[part.colour])


def _parts(rng: np.random.Generator, solid: Solid, textures: list[Texture]) -> tuple[list[Face], list[Tube]]:
    """What is seen of a thing of several parts; those of one colour and surface share a picture."""
    faces: list[Face] = []
    tubes: list[Tube] = []
    pictures: dict[tuple[str, str], int] = {}
    for part in solid.parts:
        if part.surface == "round":
            tubes.append(_part_tube(solid, part))
            continue
        look = (part.colour, part.surface)
        if look not in pictures:
            textures.append(_surface(rng, SURFACES[part.surface], part.colour, (128, 128)))
            pictures[look] = len(textures) - 1
        faces.extend(_cuboid_faces(solid, part, pictures[look]))
    return faces, tubes


def _pole_tubes(rng: np.random.Generator, solid: Solid) -> Iterator[Tube]:
    """A pole in two to six bands over a dark foot."""
    bands = int(rng.choice((1, 1, 2, 5)))
    other = list(PALETTE.values())[rng.integers(len(PALETTE))]
    edges = np.concatenate(([0.0], np.linspace(rng.uniform(0.05, 0.3), solid.height_m, bands + 1)))
    for index, (low, high) in enumerate(pairwise(edges)):
        colour = (0.12, 0.12, 0.13) if index == 0 else (PALETTE[solid.colour], other)[(index - 1) % 2]
        yield Tube((solid.x, solid.y, float(low + high) / 2), solid.half_x, float(high - low) / 2, colour)


def _wall_faces(rng: np.random.Generator, arena: Arena, textures: list[Texture]) -> Iterator[Face]:
    """Four walls, each of two or three stretches of different material, with posters and doors."""
    for side in range(4):
        turn = side * np.pi / 2
        out = (arena.length_m if side % 2 == 0 else arena.width_m) / 2
        span = arena.width_m if side % 2 == 0 else arena.length_m
        cuts = np.array((0.0, *np.sort(rng.uniform(0.2, 0.8, rng.integers(1, 3))), 1.0)) * span - span / 2
        c, s = float(np.cos(turn)), float(np.sin(turn))
        for low, high in pairwise(cuts):
            centre, half = float(low + high) / 2, float(high - low) / 2
            textures.append(_surface(rng, WALL_SURFACES, _wall_colour(rng, arena), (256, 512)))
            place = (c * out - s * centre, s * out + c * centre, arena.wall_m / 2)
            yield _upright(place, turn + np.pi, (half, arena.wall_m / 2), len(textures) - 1)
            if rng.random() < 0.7 and half > 0.8:
                yield _hanging(rng, arena, textures, turn, out - 0.02, centre)


def _hanging(
    rng: np.random.Generator, arena: Arena, textures: list[Texture], turn: float, out: float, along: float
) -> Face:
    """A poster on the wall, or a door that stands on the floor."""
    door = rng.random() < 0.4
    half = (0.5, 1.05) if door else (float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.3, 0.6)))
    height = half[1] if door else float(rng.uniform(1.2, arena.wall_m - 0.8))
    textures.append(_surface(rng, BOX_SURFACES, _any_colour(rng), (128, 128)))
    c, s = float(np.cos(turn)), float(np.sin(turn))
    place = (c * out - s * along, s * out + c * along, height)
    return _upright(place, turn + np.pi, half, len(textures) - 1)


def _any_colour(rng: np.random.Generator) -> str:
    return list(PALETTE)[rng.integers(len(PALETTE))]


def _wall_colour(rng: np.random.Generator, arena: Arena) -> str:
    return arena.floor_colours[rng.integers(3)] if rng.random() < 0.35 else _any_colour(rng)


def _surface(
    rng: np.random.Generator, painters: Sequence[Painter], colour: str, size: tuple[int, int]
) -> Texture:
    painter = painters[int(rng.integers(len(painters)))]
    tint = np.asarray(PALETTE[colour]) * rng.uniform(0.8, 1.2)
    picture = painter(rng, (float(tint[0]), float(tint[1]), float(tint[2])), *size)
    gradient = np.linspace(rng.uniform(0.9, 1.15), rng.uniform(0.7, 1.0), size[0], dtype=np.float32)
    return to_texture(picture * gradient[:, None, None])


def build_scene(rng: np.random.Generator, arena: Arena) -> Scene:
    """Faces, cylinders and pictures of an arena: floor first, then ceiling (if any), walls, solids."""
    half = (arena.length_m / 2, arena.width_m / 2)
    north, west, south = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)
    textures = [paint_floor(rng, arena).transpose(1, 0, 2)[::-1], paint_ceiling(rng)]
    faces = [Face((0.0, 0.0, 0.0), north, west, half, 0, Truth.FLOOR)]
    if not arena.open_sky:
        faces.append(Face((0.0, 0.0, arena.wall_m), south, west, half, 1, Truth.ABOVE))
    faces.extend(_wall_faces(rng, arena, textures))
    tubes: list[Tube] = []
    for solid in arena.solids:
        if solid.parts:
            seen = _parts(rng, solid, textures)
            faces.extend(seen[0])
            tubes.extend(seen[1])
        elif solid.kind == "pole":
            tubes.extend(_pole_tubes(rng, solid))
        else:
            painters = PANEL_SURFACES if solid.kind == "panel" else BOX_SURFACES
            textures.append(_surface(rng, painters, solid.colour, (128, 128)))
            faces.extend(_box_faces(solid, len(textures) - 1))
    return Scene(arena, tuple(faces), tuple(tubes), tuple(textures))


def truth_of_geoms(scene: Scene) -> NDArray[np.uint8]:
    """Label of each geom in the order of `mjcf`, and of the background (the sky) as the last one."""
    labels = [face.truth for face in scene.faces] + [Truth.OBSTACLE] * len(scene.tubes) + [Truth.ABOVE]
    return np.array(labels, np.uint8)
