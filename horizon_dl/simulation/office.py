"""Things of a crowded office or laboratory: desks with screens, swivel chairs, what lies about."""

from collections.abc import Callable
from dataclasses import replace
from functools import wraps

import numpy as np

from horizon_dl.simulation.solid import Part, Solid
from horizon_dl.simulation.things import colour_of, leg, thing

Rng = np.random.Generator

MUTED = ("white", "grey", "charcoal", "beige", "brown", "charcoal")
MUTED_SHARE = 0.8
"""Of the colours of an office's things."""


def muted(draw: Callable[[Rng], Solid]) -> Callable[[Rng], Solid]:
    """How a thing is drawn in an office's colours: most give way to white, grey and wood; black stays."""

    @wraps(draw)
    def drawn(rng: Rng) -> Solid:
        solid = draw(rng)
        other = {
            colour: str(rng.choice(MUTED)) if colour != "charcoal" and rng.random() < MUTED_SHARE else colour
            for colour in sorted({part.colour for part in solid.parts} | {solid.colour})
        }
        parts = tuple(replace(part, colour=other[part.colour]) for part in solid.parts)
        return replace(solid, colour=other[solid.colour], parts=parts)

    return drawn


def office_chair(rng: Rng) -> Solid:
    """A swivel chair by itself."""
    return thing("office chair", _office_chair_parts(rng))


def desks(rng: Rng) -> Solid:
    """One to four desks in a row with all that belongs to them; their backs are at -x."""
    parts = _row(rng, int(rng.integers(1, 5)))
    middle = (min(p.x - p.half_x for p in parts) + max(p.x + p.half_x for p in parts)) / 2
    return thing("desks", [replace(part, x=part.x - middle) for part in parts])


def desk_island(rng: Rng) -> Solid:
    """Two rows of one to three desks, back to back."""
    count, parts = int(rng.integers(1, 4)), []
    for side in (-1, 1):
        row = _row(rng, count)
        away = row[0].half_x + 0.02  # its first part is a desk's top
        parts += [replace(part, x=side * (part.x + away)) for part in row]
    return thing("desk island", parts)


def clutter(rng: Rng) -> Solid:
    """Bags, cartons and coils on the floor, from a hand's breadth to the knee."""
    parts = []
    for _ in range(int(rng.integers(2, 6))):
        x, y = (float(v) for v in rng.uniform(-0.45, 0.45, 2))
        half, tall = rng.uniform(0.06, 0.28, 2), float(rng.choice((0.08, 0.15, 0.3, 0.45)))
        round_one = rng.random() < 0.3
        size = (float(half[0]), float(half[0] if round_one else half[1]))
        parts.append(Part(x, y, *size, 0.0, tall, colour_of(rng), "round" if round_one else "box"))
    return thing("clutter", parts)


def _row(rng: Rng, count: int) -> list[Part]:
    """Desks side by side, all alike but for what stands on and under them; the people sit at +x."""
    half_x, half_y = float(rng.uniform(0.33, 0.45)), float(rng.uniform(0.55, 0.9))
    top, colour = float(rng.uniform(0.68, 0.78)), colour_of(rng, "white", "grey", "beige", "brown")
    legs, parts = rng.random() < 0.6, []
    for number in range(count):
        y = (number - (count - 1) / 2) * 2 * (half_y + 0.01)
        parts += _desk(rng, y, (half_x, half_y, top), colour, legs=legs)
    return parts


def _desk(rng: Rng, y: float, size: tuple[float, float, float], colour: str, *, legs: bool) -> list[Part]:
    """A desk at a place in its row, its screens, what is under it, and most often its chair."""
    half_x, half_y, top = size
    parts = [Part(0.0, y, half_x, half_y, top - 0.04, top, colour, "plain")]
    if legs:
        ends = [(i * (half_x - 0.04), y + j * (half_y - 0.04)) for i in (-1, 1) for j in (-1, 1)]
        parts += [leg(*end, top - 0.04) for end in ends]
    else:
        parts += [Part(0.0, y + j * (half_y - 0.02), half_x, 0.02, 0.0, top - 0.04, colour) for j in (-1, 1)]
    for side in (-0.4, 0.4)[: int(rng.integers(0, 3))]:
        parts += _screen(rng, (-half_x + 0.15, y + side * half_y), top, 0.38 * half_y)
    for _ in range(int(rng.integers(0, 4))):  # cups, books, a lamp
        (deep, wide), tall = rng.uniform(0.03, 0.15, 2), float(rng.uniform(0.02, 0.3))
        deep, along = min(float(deep), half_x - 0.1), y + float(rng.uniform(-1, 1)) * (half_y - float(wide))
        parts.append(Part(0.1, along, deep, float(wide), top, top + tall, colour_of(rng)))
    if rng.random() < 0.6:  # drawers or a computer
        wide = float(rng.uniform(0.1, 0.2))
        parts.append(Part(0.0, y + half_y - 0.25, half_x - 0.08, wide, 0.0, 0.5, colour_of(rng)))
    if rng.random() < 0.75:
        away, aside = half_x + float(rng.uniform(0.05, 0.4)), float(rng.uniform(-0.4, 0.4)) * half_y
        parts += [replace(part, x=away - part.x, y=part.y + y + aside) for part in _office_chair_parts(rng)]
    return parts


def _screen(rng: Rng, place: tuple[float, float], top: float, most: float) -> list[Part]:
    """A screen on its stand, half of it at most so wide."""
    x, y = place
    half, tall = min(most, float(rng.uniform(0.2, 0.35))), float(rng.uniform(0.25, 0.4))
    return [
        Part(x, y, 0.1, 0.12, top, top + 0.02, "charcoal", "plain"),
        Part(x, y, 0.03, 0.03, top, top + 0.12, "charcoal", "round"),
        Part(x, y, 0.03, half, top + 0.1, top + 0.1 + tall, "charcoal", "plain"),
    ]


def _office_chair_parts(rng: Rng) -> list[Part]:
    """Five feet, a column, a seat, a back at -x and arms."""
    colour, seat = colour_of(rng, "charcoal", "charcoal", "grey", "blue"), float(rng.uniform(0.42, 0.55))
    parts = [Part(0.0, 0.0, 0.23, 0.23, seat - 0.07, seat, colour, "plain"), leg(0.0, 0.0, seat - 0.06, 0.03)]
    first = float(rng.uniform(0, 2 * np.pi))
    for angle in first + np.arange(5) * 2 * np.pi / 5:
        x, y = float(np.cos(angle)), float(np.sin(angle))
        parts += [leg(0.29 * x, 0.29 * y, 0.07, 0.035)]
        parts += [Part(r * x, r * y, 0.03, 0.03, 0.06, 0.1, "charcoal", "round") for r in (0.08, 0.15, 0.22)]
    high = seat + float(rng.uniform(0.35, 0.65))
    parts.append(Part(-0.25, 0.0, 0.03, 0.21, seat + 0.06, high, colour, "plain"))
    if rng.random() < 0.6:
        parts += [Part(0.0, j * 0.25, 0.13, 0.025, seat + 0.18, seat + 0.21, "charcoal") for j in (-1, 1)]
    return parts
