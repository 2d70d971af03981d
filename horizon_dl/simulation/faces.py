"""Flat textured faces and upright cylinders: what a world is made of."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from horizon_dl.data.frame import Truth
from horizon_dl.simulation.solid import Part, Solid

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


def upright(centre: Vector, turn_rad: float, half: tuple[float, float], texture: int) -> Face:
    """An upright face whose normal points to `turn_rad` from +x towards +y."""
    right = (-float(np.sin(turn_rad)), float(np.cos(turn_rad)), 0.0)
    return Face(centre, right, UP, half, texture, Truth.OBSTACLE)


def box_faces(solid: Solid, texture: int) -> Iterator[Face]:
    """Sides and top of a box on the floor."""
    yield from cuboid_faces(solid, solid.bodies[0], texture)


def cuboid_faces(solid: Solid, part: Part, texture: int) -> Iterator[Face]:
    """Sides and top of a part, and its underside where it does not stand on the floor."""
    c, s = float(np.cos(solid.turn_rad)), float(np.sin(solid.turn_rad))
    x, y = solid.place(part)
    middle, half_height = (part.low_m + part.high_m) / 2, (part.high_m - part.low_m) / 2
    sides = ((c, s, part.half_x, part.half_y), (-s, c, part.half_y, part.half_x))
    for number, (nx, ny, out, half) in enumerate(sides):
        turn = solid.turn_rad + number * np.pi / 2
        for sign, angle in ((1, turn), (-1, turn + np.pi)):
            yield upright(
                (x + sign * nx * out, y + sign * ny * out, middle), angle, (half, half_height), texture
            )
    flat, along, across = (part.half_x, part.half_y), (c, s, 0.0), (-s, c, 0.0)
    yield Face((x, y, part.high_m), along, across, flat, texture, Truth.OBSTACLE)
    if part.low_m > 0:
        under = (part.half_y, part.half_x)
        yield Face((x, y, part.low_m), across, along, under, texture, Truth.OBSTACLE)
