"""A world as flat textured faces and cylinders, with their pictures."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Truth
from horizon_dl.simulation.faces import Face, Tube, box_faces, cuboid_faces
from horizon_dl.simulation.floor import paint_ceiling, paint_floor
from horizon_dl.simulation.layout import Arena
from horizon_dl.simulation.solid import Part, Solid
from horizon_dl.simulation.surfaces import (
    BOX_SURFACES,
    PALETTE,
    PANEL_SURFACES,
    SURFACES,
    Texture,
    painted,
)
from horizon_dl.simulation.walls import wall_faces

FLOOR = 0
"""Index of the floor's texture."""


@dataclass(frozen=True)
class Scene:
    """What the renderer needs of an arena."""

    arena: Arena
    faces: tuple[Face, ...]
    tubes: tuple[Tube, ...]
    textures: tuple[Texture, ...]


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
            textures.append(painted(rng, SURFACES[part.surface], part.colour, (128, 128)))
            pictures[look] = len(textures) - 1
        faces.extend(cuboid_faces(solid, part, pictures[look]))
    return faces, tubes


def _pole_tubes(rng: np.random.Generator, solid: Solid) -> Iterator[Tube]:
    """A pole in two to six bands over a dark foot."""
    bands = int(rng.choice((1, 1, 2, 5)))
    other = list(PALETTE.values())[rng.integers(len(PALETTE))]
    edges = np.concatenate(([0.0], np.linspace(rng.uniform(0.05, 0.3), solid.height_m, bands + 1)))
    for index, (low, high) in enumerate(pairwise(edges)):
        colour = (0.12, 0.12, 0.13) if index == 0 else (PALETTE[solid.colour], other)[(index - 1) % 2]
        yield Tube((solid.x, solid.y, float(low + high) / 2), solid.half_x, float(high - low) / 2, colour)


def build_scene(rng: np.random.Generator, arena: Arena) -> Scene:
    """Faces, cylinders and pictures of an arena: floor first, then ceiling (if any), walls, solids."""
    half = (arena.length_m / 2, arena.width_m / 2)
    north, west, south = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)
    textures = [paint_floor(rng, arena).transpose(1, 0, 2)[::-1], paint_ceiling(rng)]
    faces = [Face((0.0, 0.0, 0.0), north, west, half, FLOOR, Truth.FLOOR)]
    if not arena.open_sky:
        faces.append(Face((0.0, 0.0, arena.wall_m), south, west, half, 1, Truth.ABOVE))
    faces.extend(wall_faces(rng, arena, textures))
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
            textures.append(painted(rng, painters, solid.colour, (128, 128)))
            faces.extend(box_faces(solid, len(textures) - 1))
    return Scene(arena, tuple(faces), tuple(tubes), tuple(textures))


def truth_of_geoms(scene: Scene) -> NDArray[np.uint8]:
    """Label of each geom in the order of `mjcf`, and of the background (the sky) as the last one."""
    labels = [face.truth for face in scene.faces] + [Truth.OBSTACLE] * len(scene.tubes) + [Truth.ABOVE]
    return np.array(labels, np.uint8)
