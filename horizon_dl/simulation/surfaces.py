"""Procedural textures of walls, curtains, boxes and panels; each is a picture of one whole face."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from horizon_dl.simulation.noise import Field, fractal_noise, value_noise

Texture = NDArray[np.uint8]
Colour = tuple[float, float, float]

# Dyes and paints, sRGB in [0, 1]; floors and obstacles draw from the same list.
PALETTE: dict[str, Colour] = {
    "green": (0.24, 0.37, 0.20),
    "blue": (0.15, 0.30, 0.46),
    "charcoal": (0.17, 0.17, 0.20),
    "grey": (0.46, 0.46, 0.45),
    "beige": (0.63, 0.55, 0.42),
    "brown": (0.40, 0.27, 0.17),
    "brick": (0.52, 0.25, 0.19),
    "white": (0.80, 0.80, 0.77),
    "orange": (0.85, 0.36, 0.12),
    "yellow": (0.82, 0.68, 0.20),
    "violet": (0.28, 0.21, 0.36),
    "teal": (0.16, 0.42, 0.40),
}


def shade(colour: Colour, factor: Field | NDArray[np.float64]) -> NDArray[np.float32]:
    """A colour under a field of factors: (h, w) to (h, w, 3) float32."""
    return np.asarray(colour, np.float32) * np.asarray(factor, np.float32)[..., None]


def to_texture(picture: NDArray[np.float32]) -> Texture:
    """Float picture in [0, 1] to uint8."""
    return (np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8)


def plaster(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Painted plaster with stains and a darker skirting zone."""
    stains = 0.16 * fractal_noise(rng, height, width, (3, 5), 6)
    grime = 0.15 * np.exp(-np.linspace(8, 0, height, dtype=np.float32))[:, None]
    return shade(colour, 1 + stains - grime)


def concrete(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Cast concrete: strong mottling, pores, joints between the slabs."""
    mottled = 1 + 0.35 * fractal_noise(rng, height, width, (4, 6), 7)
    pores = value_noise(rng, height, width, (height, width)) > 0.985
    joints = np.zeros((height, width), bool)
    joints[:: max(height // 2, 1)] = True
    joints[:, :: max(width // 3, 1)] = True
    return shade(colour, mottled * np.where(pores | joints, 0.65, 1.0))


def bricks(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """A running bond of bricks, each with its own tone, in grey mortar."""
    rows, columns = max(height // 10, 4), max(width // 22, 4)
    v = (np.arange(height) * rows / height)[:, None]
    u = (np.arange(width) * columns / width)[None, :] + 0.5 * (np.floor(v) % 2)
    tone = rng.normal(1, 0.13, (rows, columns + 1)).astype(np.float32)
    brick = tone[np.floor(v).astype(int), np.floor(u).astype(int) % (columns + 1)]
    mortar = (v % 1 < 0.14) | (u % 1 < 0.07)
    grain = 1 + 0.25 * fractal_noise(rng, height, width, (8, 8), 5)
    return np.where(mortar[..., None], shade((0.55, 0.53, 0.50), grain), shade(colour, brick * grain))


def planks(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Upright wooden boards with grain."""
    boards = max(width // 34, 3)
    index = np.floor(np.arange(width) * boards / width).astype(int)
    tone = rng.normal(1, 0.10, boards).astype(np.float32)[index]
    gap = np.diff(index, prepend=0) > 0
    grain = fractal_noise(rng, height, width, (3, min(8 * boards, width)), 4)
    return shade(colour, (tone * np.where(gap, 0.5, 1.0))[None, :] * (1 + 0.4 * grain))


def curtain(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Hanging cloth: irregular vertical folds that fan out downwards, and a weave."""
    sway = fractal_noise(rng, height, width, (2, 6), 3)
    across = np.linspace(0, 1, width, dtype=np.float32)[None, :]
    folds = np.sin(2 * np.pi * (rng.uniform(14, 26) * across + 0.45 * sway))
    weave = rng.normal(0, 0.03, (height, width)).astype(np.float32)
    return shade(colour, 0.85 + 0.2 * folds + 0.3 * sway + weave)


def corrugated(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Corrugated sheet with rust runs."""
    ridges = np.sin(2 * np.pi * np.linspace(0, max(width // 12, 4), width, dtype=np.float32))[None, :]
    rust = np.clip(3 * fractal_noise(rng, height, width, (2, 16), 5), 0, 1)[..., None]
    sheet = shade(colour, np.broadcast_to(0.85 + 0.2 * ridges, (height, width)))
    red = np.asarray((0.40, 0.22, 0.12), np.float32)
    return np.asarray(sheet * (1 - 0.6 * rust) + 0.6 * rust * red, np.float32)


def cardboard(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """A carton: fibres, a strip of tape, a label."""
    picture = shade(colour, 1 + 0.14 * fractal_noise(rng, height, width, (4, 16), 5))
    middle = width // 2
    picture[:, middle - width // 24 : middle + width // 24] *= 1.18
    top, left = int(rng.uniform(0.15, 0.6) * height), int(rng.uniform(0.08, 0.3) * width)
    picture[top : top + height // 5, left : left + width // 5] = 0.78
    return picture


def stripes(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """A printed board: slanting bands of two tones."""
    v, u = np.mgrid[0 : 1 : height * 1j, 0 : 1 : width * 1j]
    bands = (rng.uniform(4, 8) * u + rng.uniform(-3, 3) * v) % 1 < 0.5
    other = list(PALETTE.values())[rng.integers(len(PALETTE))]
    dirt = 1 + 0.15 * fractal_noise(rng, height, width, (4, 4), 5)
    return np.where(bands[..., None], shade(colour, dirt), shade(other, dirt))


def mottled(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Camouflage-like cloth: three tones of one colour in blotches."""
    field = fractal_noise(rng, height, width, (7, 7), 4)
    tones = np.select([field < -0.12, field < 0.1], [0.55, 0.95], 1.45)
    return shade(colour, tones * (1 + 0.1 * rng.normal(0, 1, (height, width))))


def plain(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Paint, lacquer or laminate: one colour, hardly worn."""
    return shade(colour, 1 + 0.06 * fractal_noise(rng, height, width, (2, 3), 4))


def leaves(rng: np.random.Generator, colour: Colour, height: int, width: int) -> NDArray[np.float32]:
    """Foliage: leaves in light and holes in the dark."""
    field = fractal_noise(rng, height, width, (14, 14), 4)
    tones = np.select([field < -0.15, field < 0.12], [0.3, 0.85], 1.5)
    return shade(colour, tones * (1 + 0.2 * rng.normal(0, 1, (height, width))))


Painter = Callable[[np.random.Generator, Colour, int, int], NDArray[np.float32]]
WALL_SURFACES: tuple[Painter, ...] = (plaster, concrete, bricks, planks, curtain, curtain, corrugated)
BOX_SURFACES: tuple[Painter, ...] = (cardboard, planks, concrete, plaster, mottled, stripes)
PANEL_SURFACES: tuple[Painter, ...] = (stripes, curtain, planks, mottled, plaster, corrugated)
SURFACES: dict[str, tuple[Painter, ...]] = {
    "box": BOX_SURFACES,
    "plain": (plain,),
    "leaves": (leaves,),
}


def painted(
    rng: np.random.Generator, painters: Sequence[Painter], colour: str, size: tuple[int, int]
) -> Texture:
    """One of the surfaces in a tint of a colour, (h, w) = size, darker towards one end."""
    painter = painters[int(rng.integers(len(painters)))]
    tint = np.asarray(PALETTE[colour]) * rng.uniform(0.8, 1.2)
    picture = painter(rng, (float(tint[0]), float(tint[1]), float(tint[2])), *size)
    gradient = np.linspace(rng.uniform(0.9, 1.15), rng.uniform(0.7, 1.0), size[0], dtype=np.float32)
    return to_texture(picture * gradient[:, None, None])
