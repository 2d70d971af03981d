"""Things of cluttered rooms, hallways, yards and streets, many of them lower than a camera: drawn by a seed.

Each function gives a `Solid` at the origin; its parts reach no further than its outline.
"""

from dataclasses import replace

import numpy as np

from horizon_dl.simulation.solid import Part, Solid
from horizon_dl.simulation.surfaces import PALETTE

Rng = np.random.Generator


def colour_of(rng: Rng, *names: str) -> str:
    """One of the names, else of the whole palette."""
    choice = names or tuple(PALETTE)
    return choice[int(rng.integers(len(choice)))]


def thing(kind: str, parts: list[Part]) -> Solid:
    """The solid whose outline is the box round its parts."""
    half_x = max(abs(part.x) + part.half_x for part in parts)
    half_y = max(abs(part.y) + part.half_y for part in parts)
    height = max(part.high_m for part in parts)
    return Solid(kind, 0.0, 0.0, 0.0, half_x, half_y, height, parts[0].colour, tuple(parts))


def leg(x: float, y: float, high_m: float, radius_m: float = 0.025) -> Part:
    """A dark upright tube from the floor."""
    return Part(x, y, radius_m, radius_m, 0.0, high_m, "charcoal", "round")


def _chair_parts(rng: Rng, x: float, y: float) -> list[Part]:
    """Seat, back and four legs."""
    colour, seat = colour_of(rng), float(rng.uniform(0.42, 0.5))
    side = 0.22
    back = Part(x - side, y, 0.025, side, seat, seat + float(rng.uniform(0.3, 0.5)), colour)
    legs = [leg(x + i * 0.18, y + j * 0.18, seat - 0.04) for i in (-1, 1) for j in (-1, 1)]
    return [Part(x, y, side, side, seat - 0.04, seat, colour), back, *legs]


def chair(rng: Rng) -> Solid:
    """A chair by itself."""
    return thing("chair", _chair_parts(rng, 0.0, 0.0))


def workplace(rng: Rng) -> Solid:
    """A desk on legs or sides, what stands on it, drawers, and up to two chairs; its back is at -x."""
    half_x, half_y = float(rng.uniform(0.35, 0.5)), float(rng.uniform(0.6, 1.0))
    top, colour = float(rng.uniform(0.68, 0.78)), colour_of(rng)
    parts = [Part(0.0, 0.0, half_x, half_y, top - 0.04, top, colour, "plain")]
    if rng.random() < 0.5:
        corners = [(i * (half_x - 0.05), j * (half_y - 0.05)) for i in (-1, 1) for j in (-1, 1)]
        parts += [leg(x, y, top - 0.04) for x, y in corners]
    else:
        parts += [Part(0.0, j * (half_y - 0.02), half_x, 0.02, 0.0, top - 0.04, colour) for j in (-1, 1)]
    if rng.random() < 0.6:
        parts.append(Part(0.0, half_y - 0.3, half_x - 0.08, 0.2, 0.0, 0.55, colour_of(rng), "plain"))
    for _ in range(int(rng.integers(1, 4))):
        tall, half = float(rng.uniform(0.05, 0.4)), rng.uniform(0.04, 0.25, 2)
        y = float(rng.uniform(-1, 1) * (half_y - half[1]))
        parts.append(Part(0.0, y, float(half[0]), float(half[1]), top, top + tall, colour_of(rng)))
    for side in (-1, 1)[: int(rng.integers(0, 3))]:  # one alone is not between desk and wall
        y = float(rng.uniform(-0.4, 0.4) * half_y)
        seat = _chair_parts(rng, -(half_x + 0.25), y)
        parts += [
            Part(side * p.x, p.y, p.half_x, p.half_y, p.low_m, p.high_m, p.colour, p.surface) for p in seat
        ]
    return thing("workplace", parts)


def shelf(rng: Rng) -> Solid:
    """Boards between two sides, and boxes on them; its back is at -x."""
    half_x, half_y = float(rng.uniform(0.15, 0.3)), float(rng.uniform(0.4, 0.9))
    height, colour = float(rng.choice((0.8, 1.1, 1.8, 2.0))), colour_of(rng)
    levels = np.linspace(0.05, height - 0.02, int(height / 0.38) + 1)
    parts = [Part(0.0, j * half_y, half_x, 0.02, 0.0, height, colour, "plain") for j in (-1, 1)]
    parts += [Part(0.0, 0.0, half_x, half_y, float(z), float(z) + 0.025, colour, "plain") for z in levels]
    parts.append(Part(0.02 - half_x, 0.0, 0.01, half_y, 0.05, height, colour_of(rng), "plain"))
    for z in levels[:-1]:
        for place in np.arange(-half_y + 0.2, half_y - 0.15, 0.35):
            if rng.random() < 0.7:
                tall = float(rng.uniform(0.1, 0.3))
                low = float(z) + 0.025
                parts.append(Part(0.0, float(place), half_x - 0.04, 0.13, low, low + tall, colour_of(rng)))
    return thing("shelf", parts)


def stairs(rng: Rng) -> Solid:
    """Three to seven steps, or one step of a landing; they rise towards -x."""
    count, colour = (
        int(rng.choice((1, 3, 5, 7))),
        colour_of(rng, "grey", "beige", "white", "brown", "charcoal"),
    )
    rise, run = float(rng.uniform(0.14, 0.19)), 0.28 if count > 1 else 0.8
    half_y, half_x = float(rng.uniform(0.5, 1.0)), count * run / 2
    parts = []
    for step in range(count):
        length = (count - step) * run
        x = length / 2 - half_x
        parts.append(Part(x, 0.0, length / 2, half_y, step * rise, (step + 1) * rise, colour, "plain"))
    return thing("stairs", parts)


def low_boxes(rng: Rng) -> Solid:
    """One to four cartons, crates or bags, ankle-high to knee-high, in a heap."""
    parts = []
    for number in range(int(rng.integers(1, 5))):
        half, tall = rng.uniform(0.1, 0.3, 2), float(rng.uniform(0.12, 0.5))
        x, y = (0.0, 0.0) if number == 0 else (float(v) for v in rng.uniform(-0.4, 0.4, 2))
        parts.append(Part(x, y, float(half[0]), float(half[1]), 0.0, tall, colour_of(rng)))
    return thing("low boxes", parts)


def chairs(rng: Rng) -> Solid:
    """One to four chairs in a row; their backs are at -x."""
    count, state = int(rng.integers(1, 5)), int(rng.integers(2**32))
    alike = [
        _chair_parts(np.random.default_rng(state), 0.0, (i - (count - 1) / 2) * 0.55) for i in range(count)
    ]
    return thing("chairs", [part for parts in alike for part in parts])


def cabinet(rng: Rng) -> Solid:
    """A closed cabinet, locker, radiator or copier."""
    size = (float(rng.uniform(0.1, 0.35)), float(rng.uniform(0.25, 0.9)), float(rng.uniform(0.5, 2.1)))
    return thing("cabinet", [Part(0.0, 0.0, size[0], size[1], 0.0, size[2], colour_of(rng), "plain")])


def trolley(rng: Rng) -> Solid:
    """A trolley, or a bed on wheels: a frame with a board or two, and what lies on it; its side is at -x."""
    half_x, half_y = float(rng.uniform(0.22, 0.45)), float(rng.uniform(0.35, 1.0))
    top, colour = float(rng.uniform(0.5, 0.95)), colour_of(rng, "white", "grey", "blue", "charcoal")
    corners = [(i * (half_x - 0.04), j * (half_y - 0.04)) for i in (-1, 1) for j in (-1, 1)]
    thick = float(rng.uniform(0.03, 0.2))
    parts = [Part(0.0, 0.0, half_x, half_y, top - thick, top, colour, "plain")]
    parts += [leg(x, y, top - thick) for x, y in corners]
    if rng.random() < 0.5:
        parts.append(Part(0.0, 0.0, half_x - 0.03, half_y - 0.03, 0.18, 0.22, colour, "plain"))
    for end in (-1, 1)[: int(rng.integers(0, 3))]:
        high = top + float(rng.uniform(0.15, 0.5))
        parts.append(Part(0.0, end * (half_y - 0.02), half_x, 0.02, top - 0.1, high, colour_of(rng), "plain"))
    if rng.random() < 0.6:
        tall, side = float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.3, 0.9))
        parts.append(Part(0.0, 0.0, half_x * side, half_y * side, top, top + tall, colour_of(rng)))
    return thing("trolley", parts)


def open_door(rng: Rng) -> Solid:
    """The leaf of a door that stands open into the way."""
    half, colour = float(rng.uniform(0.35, 0.5)), colour_of(rng)
    return thing("open door", [Part(0.0, 0.0, half, 0.025, 0.0, 2.05, colour, "plain")])


def pillar(rng: Rng) -> Solid:
    """A part of the wall that juts out, to above every camera."""
    size = (float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.15, 0.5)))
    colour = colour_of(rng, "white", "beige", "grey")
    return thing("pillar", [Part(0.0, 0.0, size[0], size[1], 0.0, 3.4, colour, "plain")])


def waste_bin(rng: Rng) -> Solid:
    """A bin, a fire extinguisher or a flower pot."""
    radius, height = float(rng.uniform(0.08, 0.25)), float(rng.uniform(0.3, 0.8))
    return Solid("pole", 0.0, 0.0, 0.0, radius, radius, height, colour_of(rng))


def tree(rng: Rng) -> Solid:
    """A trunk and a crown over the camera."""
    trunk, crown = float(rng.uniform(0.08, 0.25)), float(rng.uniform(0.7, 1.6))
    foot, top = float(rng.uniform(2.3, 3.0)), float(rng.uniform(4.0, 6.0))
    parts = [
        Part(0.0, 0.0, trunk, trunk, 0.0, foot + 0.3, colour_of(rng, "brown", "charcoal", "grey"), "round")
    ]
    for share, size in ((0.0, 0.8), (0.3, 1.0), (0.6, 0.75), (0.85, 0.4)):
        low = foot + share * (top - foot)
        parts.append(
            Part(0.0, 0.0, crown * size, crown * size, low, low + 0.3 * (top - foot), "green", "round")
        )
    solid = thing("tree", parts)
    return replace(solid, half_x=trunk, half_y=trunk)  # one flies under the crown


def bush(rng: Rng) -> Solid:
    """Two to five leafy blocks, knee-high to head-high."""
    colour, parts = colour_of(rng, "green", "green", "brown", "teal"), []
    for _ in range(int(rng.integers(2, 6))):
        x, y = (float(v) for v in rng.uniform(-0.5, 0.5, 2))
        half = rng.uniform(0.2, 0.5, 2)
        tall = float(rng.uniform(0.4, 1.4))
        parts.append(Part(x, y, float(half[0]), float(half[1]), 0.0, tall, colour, "leaves"))
    return thing("bush", parts)


def hedge(rng: Rng) -> Solid:
    """A long leafy block."""
    size = (float(rng.uniform(0.25, 0.4)), float(rng.uniform(1.0, 2.5)), float(rng.uniform(0.6, 1.8)))
    return thing("hedge", [Part(0.0, 0.0, size[0], size[1], 0.0, size[2], "green", "leaves")])


def car(rng: Rng) -> Solid:
    """Body, cabin and four wheels; lower than a camera held at the eyes."""
    colour = colour_of(rng, "white", "charcoal", "grey", "blue", "brick")
    half_x, half_y = float(rng.uniform(1.8, 2.3)), float(rng.uniform(0.8, 0.92))
    waist, roof = float(rng.uniform(0.8, 0.95)), float(rng.uniform(1.4, 1.7))
    wheels = [(i * half_x * 0.62, j * (half_y - 0.08)) for i in (-1, 1) for j in (-1, 1)]
    return thing(
        "car",
        [
            Part(0.0, 0.0, half_x, half_y, 0.22, waist, colour, "plain"),
            Part(-0.1, 0.0, half_x * 0.5, half_y - 0.1, waist, roof, "charcoal", "plain"),
            *(Part(x, y, 0.31, 0.1, 0.0, 0.6, "charcoal", "plain") for x, y in wheels),
        ],
    )


def person(rng: Rng) -> Solid:
    """Somebody who stands or walks."""
    tall, stride = float(rng.uniform(1.1, 1.9)), float(rng.uniform(0.0, 0.2))
    hip, neck, coat = 0.48 * tall, 0.84 * tall, colour_of(rng)
    legs = colour_of(rng, "charcoal", "blue", "brown", "grey")
    return thing(
        "person",
        [
            *(Part(i * stride, i * 0.09, 0.07, 0.07, 0.0, hip + 0.05, legs, "round") for i in (-1, 1)),
            Part(0.0, 0.0, 0.11, 0.21, hip, neck, coat, "plain"),
            Part(0.0, 0.0, 0.09, 0.09, neck, tall, colour_of(rng, "beige", "brown", "charcoal"), "round"),
        ],
    )


def bench(rng: Rng) -> Solid:
    """A garden bench with a back."""
    colour, half_y = colour_of(rng, "brown", "green", "grey"), float(rng.uniform(0.6, 0.9))
    return thing(
        "bench",
        [
            Part(0.0, 0.0, 0.22, half_y, 0.4, 0.45, colour),
            Part(-0.2, 0.0, 0.03, half_y, 0.45, 0.85, colour),
            *(Part(0.0, j * (half_y - 0.15), 0.2, 0.03, 0.0, 0.4, "charcoal", "plain") for j in (-1, 1)),
        ],
    )


def post(rng: Rng) -> Solid:
    """A lamp post or a bollard."""
    radius, height = float(rng.uniform(0.05, 0.12)), float(rng.choice((0.7, 1.0, 3.0, 4.0)))
    return Solid("pole", 0.0, 0.0, 0.0, radius, radius, height, colour_of(rng))
