"""The floor as one picture: its material, what lies on it, baked light and shadows."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from horizon_dl.simulation.layout import PAVEMENT_SHARE, Arena
from horizon_dl.simulation.noise import fractal_noise, value_noise
from horizon_dl.simulation.surfaces import PALETTE, Texture, shade, to_texture

SIZE = 2048  # pixels a side; 4 to 14 mm a pixel

Picture = NDArray[np.float32]
Grid = NDArray[np.float32]


def _colour(rng: np.random.Generator) -> NDArray[np.float32]:
    return np.asarray(list(PALETTE.values())[rng.integers(len(PALETTE))], np.float32)


def _carpets(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    """Strips of three carpets, with fibre noise and wear."""
    edges = np.sort(rng.uniform(-arena.length_m / 2, arena.length_m / 2, 3))
    index = np.searchsorted(edges, x[:, 0]) % 3
    colours = np.array([PALETTE[c] for c in arena.floor_colours], np.float32)
    border = arena.width_m / 2 - rng.uniform(0.4, 1.2)
    index = np.where(np.abs(y) > border, (index[:, None] + 1) % 3, index[:, None])
    tones = np.array([_carpet_tone(rng, style) for style in rng.permutation(4)[:3]])
    chosen = np.take_along_axis(tones, index[None], axis=0)[0]
    return np.asarray(colours[index] * chosen[..., None], np.float32)


def _carpet_tone(rng: np.random.Generator, style: int) -> Picture:
    """Factor of one carpet: worn pile, speckles, carpet tiles laid crosswise, or blotches."""
    fibres = 0.10 * rng.standard_normal((SIZE, SIZE), dtype=np.float32)
    tone = 1 + fibres + 0.25 * fractal_noise(rng, SIZE, SIZE, (9, 9), 6)
    if style == 1:
        tone += 0.5 * (value_noise(rng, SIZE, SIZE, (SIZE // 3, SIZE // 3)) > 0.85)
    elif style == 2:
        cells = np.kron(rng.normal(0, 0.10, (32, 32)), np.ones((SIZE // 32, SIZE // 32)))
        joints = np.arange(SIZE) % (SIZE // 32) < 2
        tone += cells - 0.25 * (joints[:, None] | joints[None, :])
    elif style == 3:
        tone += 0.5 * (fractal_noise(rng, SIZE, SIZE, (40, 40), 3) > 0.12)
    return np.asarray(tone, np.float32)


def _mat_pattern(rng: np.random.Generator, along: Grid, across: Grid) -> Picture:
    """One of three mats: checkerboard, flowers, stripes."""
    one, two = _colour(rng), _colour(rng)
    kind = rng.integers(3)
    if kind == 0:
        dark = (np.floor(along / 0.22) + np.floor(across / 0.22)) % 2 > 0
    elif kind == 1:
        phase = rng.uniform(0, 7, 4)
        waves = np.sin(17 * along + phase[0]) * np.sin(15 * across + phase[1])
        dark = waves + 0.7 * np.sin(31 * along + 9 * across + phase[2]) > 0.15
    else:
        dark = (along / 0.3) % 1 < 0.5
    return np.where(dark[..., None], one, two * 1.1).astype(np.float32)


def _add_mats(rng: np.random.Generator, picture: Picture, arena: Arena, x: Grid, y: Grid) -> None:
    for _ in range(int(rng.integers(5, 8))):
        centre = rng.uniform((-0.42, -0.42), (0.42, 0.42)) * (arena.length_m, arena.width_m)
        turn, half = rng.uniform(0, np.pi), rng.uniform((0.6, 0.4), (1.2, 0.9))
        c, s = np.cos(turn), np.sin(turn)
        along = (x - centre[0]) * c + (y - centre[1]) * s
        across = -(x - centre[0]) * s + (y - centre[1]) * c
        inside = (np.abs(along) < half[0]) & (np.abs(across) < half[1])
        picture[inside] = _mat_pattern(rng, along[inside], across[inside])
        picture[inside] *= 1 + 0.12 * rng.normal(0, 1, (int(inside.sum()), 1)).astype(np.float32)


def _add_lines(rng: np.random.Generator, picture: Picture, arena: Arena, x: Grid, y: Grid) -> None:
    """Painted court lines and a circle."""
    paint = _colour(rng) * 0.5 + 0.4
    half_x, half_y = arena.length_m / 2 - 1.3, arena.width_m / 2 - 1.1
    edge = np.maximum(np.abs(x) - half_x, np.abs(y) - half_y)
    lines = (np.abs(edge) < 0.035) | (np.abs(np.hypot(x - 1, y + 0.5) - rng.uniform(1.2, 2.0)) < 0.035)
    lines |= (np.abs(y - rng.uniform(-2, 2)) < 0.03) & (np.abs(x) < half_x)
    worn = rng.random((SIZE, SIZE), dtype=np.float32) > 0.25
    picture[lines & worn] = paint


def _light(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    """Factor of the lamps' unevenness and of the shade at the foot of solids and walls."""
    light = 1 + 0.45 * fractal_noise(rng, SIZE, SIZE, (2, 2), 2)
    points = np.stack((x[::8, ::8].ravel(), y[::8, ::8].ravel()), axis=1).astype(np.float64)
    near = arena.clearance(points).reshape(SIZE // 8, SIZE // 8)
    shadow = 0.45 * np.exp(-np.maximum(near, 0) / 0.22)
    return light * (1 - np.kron(shadow, np.ones((8, 8)))).astype(np.float32)


def _carpeted(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    picture = _carpets(rng, arena, x, y)
    _add_mats(rng, picture, arena, x, y)
    _add_lines(rng, picture, arena, x, y)
    return picture


def _tint(arena: Arena) -> NDArray[np.float32]:
    """The colour of a floor of one material."""
    return np.asarray(PALETTE[arena.floor_colours[0]], np.float32)


def _lino(rng: np.random.Generator, arena: Arena, _x: Grid, _y: Grid) -> Picture:
    """One sheet, hardly marked."""
    tone = 1 + 0.12 * fractal_noise(rng, SIZE, SIZE, (6, 6), 5)
    return _tint(arena) * (tone + 0.04 * rng.standard_normal((SIZE, SIZE), dtype=np.float32))[..., None]


def _slabs(
    rng: np.random.Generator, arena: Arena, x: Grid, y: Grid, length_m: float, width_m: float
) -> Picture:
    """Pieces of one size, each with its tone, and the joints between them."""
    row = np.floor(y / width_m)
    place = x / length_m + 0.5 * (row % 2)
    column = np.floor(place)
    tones = rng.normal(1, 0.09, (512, 512)).astype(np.float32)
    tone = tones[row.astype(int) % 512, column.astype(int) % 512]
    joint_m = max(0.008, float(x[1, 0] - x[0, 0]), float(y[0, 1] - y[0, 0]))  # a pixel at least
    joint = np.minimum(np.abs(y / width_m - row) * width_m, np.abs(place - column) * length_m) < joint_m
    grain = 1 + 0.15 * fractal_noise(rng, SIZE, SIZE, (30, 60), 4)
    return np.asarray(_tint(arena) * (tone * grain * np.where(joint, 0.55, 1.0))[..., None], np.float32)


def _boards(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    return _slabs(rng, arena, x, y, 1.8, 0.14)


def _tiles(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    return _slabs(rng, arena, x, y, 0.4, 0.4)


def _paving(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    return _slabs(rng, arena, x, y, 0.5, 0.25)


def _grass(rng: np.random.Generator, _arena: Arena, _x: Grid, _y: Grid) -> Picture:
    """Blades, tufts, and bare patches."""
    tufts = fractal_noise(rng, SIZE, SIZE, (60, 60), 5)
    blades = 0.28 * rng.standard_normal((SIZE, SIZE), dtype=np.float32)
    picture = shade(PALETTE["green"], 1.1 + 0.9 * tufts + blades)
    bare = fractal_noise(rng, SIZE, SIZE, (9, 9), 5) > 0.25
    picture[bare] = (shade(PALETTE["brown"], 1.1 + 0.5 * tufts + 0.6 * blades))[bare]
    return picture


def _gravel(rng: np.random.Generator, arena: Arena, _x: Grid, _y: Grid) -> Picture:
    """Stones of a few centimetres, or asphalt from further off."""
    stones = 0.5 * value_noise(rng, SIZE, SIZE, (SIZE // 3, SIZE // 3)) + 0.75
    stains = 0.3 * fractal_noise(rng, SIZE, SIZE, (7, 7), 5)
    grey = 0.5 * _tint(arena) + 0.5 * np.asarray(PALETTE["grey"], np.float32)
    return np.asarray(grey * (stones + stains)[..., None], np.float32)


def _path(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    """A winding way of slabs through grass."""
    middle = rng.uniform(-0.2, 0.2) * arena.width_m + 1.5 * np.sin(
        x * rng.uniform(0.15, 0.4) + rng.uniform(0, 6)
    )
    on_it = np.abs(y - middle) < rng.uniform(1.0, 2.5)
    return np.where(on_it[..., None], _paving(rng, arena, x, y), _grass(rng, arena, x, y)).astype(np.float32)


def _street(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Picture:
    """Asphalt with patches and perhaps a broken line, kerbs, and slabs or grass on both sides."""
    road = _gravel(rng, arena, x, y) * rng.uniform(0.6, 1.1)
    for _ in range(int(rng.integers(0, 6))):
        centre, half = rng.uniform(-0.5, 0.5, 2) * (arena.length_m, arena.width_m), rng.uniform(0.4, 2.0, 2)
        road[(np.abs(x - centre[0]) < half[0]) & (np.abs(y - centre[1]) < half[1])] *= rng.uniform(0.7, 1.2)
    if rng.random() < 0.5:
        road[(np.abs(y) < 0.07) & ((x / rng.uniform(2.0, 5.0)) % 1 < 0.5)] = 0.75
    kerb = np.abs(y) - (0.5 - PAVEMENT_SHARE) * arena.width_m
    side = _paving(rng, arena, x, y) if rng.random() < 0.7 else _grass(rng, arena, x, y)
    picture = np.where((kerb > 0)[..., None], side, road).astype(np.float32)
    picture[np.abs(kerb) < 0.08] = PALETTE["grey"]
    return picture


GROUNDS: dict[str, Callable[[np.random.Generator, Arena, Grid, Grid], Picture]] = {
    "carpets": _carpeted,
    "lino": _lino,
    "boards": _boards,
    "tiles": _tiles,
    "grass": _grass,
    "gravel": _gravel,
    "paving": _paving,
    "path": _path,
    "street": _street,
}


def _sunshine(rng: np.random.Generator, arena: Arena, x: Grid, y: Grid) -> Grid:
    """Factor of the sun's light: shadows of walls and solids, and of a tree or a cloud here and there."""
    assert arena.sun_rad is not None
    azimuth, height = arena.sun_rad
    points = np.stack((x[::4, ::4].ravel(), y[::4, ::4].ravel()), axis=1).astype(np.float64)
    towards = np.array((np.cos(azimuth), np.sin(azimuth))) / np.tan(height)
    half = np.array((arena.length_m, arena.width_m)) / 2
    shaded = (np.abs(points + arena.wall_m * towards) > half).any(axis=1)
    for solid in arena.solids:
        shaded |= solid.shades(points, towards)
    shaded = shaded.reshape(SIZE // 4, SIZE // 4)
    dappled = fractal_noise(rng, SIZE // 4, SIZE // 4, (5, 5), 5) > rng.uniform(0.15, 0.45)
    light = np.where(shaded | dappled, rng.uniform(0.35, 0.6), 1.15).astype(np.float32)
    return np.kron(light, np.ones((4, 4), np.float32))


def paint_floor(rng: np.random.Generator, arena: Arena) -> Texture:
    """The floor's picture.

    Returns:
        (SIZE, SIZE, 3) uint8; rows run along +x (north), columns along +y (west), both over the arena's
        full size.
    """
    x, y = np.mgrid[-0.5 : 0.5 : SIZE * 1j, -0.5 : 0.5 : SIZE * 1j]
    x, y = (x * arena.length_m).astype(np.float32), (y * arena.width_m).astype(np.float32)
    picture = GROUNDS[arena.ground](rng, arena, x, y) * _light(rng, arena, x, y)[..., None]
    return to_texture(picture if arena.sun_rad is None else picture * _sunshine(rng, arena, x, y)[..., None])


def paint_ceiling(rng: np.random.Generator, size: int = 512) -> Texture:
    """Ceiling tiles with rows of lamps: (size, size, 3) uint8."""
    v, u = np.mgrid[0 : 16 : size * 1j, 0 : 16 : size * 1j]
    tiles = np.where((v % 1 < 0.05) | (u % 1 < 0.05), 0.8, 1.0)
    base = shade((0.50, 0.50, 0.48), tiles * (1 + 0.2 * fractal_noise(rng, size, size, (6, 6), 5)))
    lamps = (np.floor(v) % 4 == 1) & (np.floor(u) % 3 == 1) & (v % 1 > 0.1) & (u % 1 > 0.1)
    base[lamps] = (1.0, 1.0, 0.95)
    return to_texture(base)
