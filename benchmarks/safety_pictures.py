"""Made-up and degraded pictures for `safety.py`: what a camera may deliver when it shows no free space."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter

Picture = NDArray[np.uint8]
Mask = NDArray[np.bool_]
Kind = Literal["nothing", "not there", "degraded"]


@dataclass(frozen=True)
class Scene:
    """A frame and what else is needed to spoil it.

    Attributes:
        image: (H, W, 3) of the flown camera.
        floor: (H, W) pixels of the floor, or all below the horizon where no truth is known.
        later: (H, W, 3) a frame of the same recording some time after.
        others: pictures of other places, of any size.
    """

    image: Picture
    floor: Mask
    later: Picture
    others: Mapping[str, Picture]


@dataclass(frozen=True)
class Spoiled:
    """A picture and (H, W) where nothing of the world is left in it; None: all of it shows something."""

    image: Picture
    lost: Mask | None = None


Make = Callable[[Scene, np.random.Generator], Spoiled]
PICTURES: dict[str, tuple[Kind, Make]] = {}


def _add(name: str, kind: Kind, make: Callable[[Scene, np.random.Generator], Picture | Spoiled]) -> None:
    def spoiled(scene: Scene, rng: np.random.Generator) -> Spoiled:
        found = make(scene, rng)
        return found if isinstance(found, Spoiled) else Spoiled(found)

    PICTURES[name] = (kind, spoiled)


def _bytes(values: NDArray[np.floating]) -> Picture:
    return np.asarray(np.clip(values, 0, 255).round(), np.uint8)


def _flat(scene: Scene, colour: object) -> NDArray[np.float64]:
    return np.zeros(scene.image.shape) + np.asarray(colour, np.float64)


def _noisy(values: NDArray[np.floating], sd: float, rng: np.random.Generator) -> Picture:
    return _bytes(values + rng.normal(0, sd, values.shape))


def _places(scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Row and column of each pixel, from -1 to 1."""
    height, width = scene.image.shape[:2]
    v, u = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    return v, u


def _floor_colour(scene: Scene) -> NDArray[np.float64]:
    return np.asarray(np.median(scene.image[scene.floor], axis=0), np.float64)


def _fitted(picture: Picture, scene: Scene) -> Picture:
    height, width = scene.image.shape[:2]
    return np.asarray(Image.fromarray(picture).resize((width, height), Image.Resampling.BILINEAR))


def _blurred(picture: Picture, radius: float) -> Picture:
    return np.asarray(Image.fromarray(picture).filter(ImageFilter.GaussianBlur(radius)))


def _motion(picture: Picture, pixels: int, axis: int) -> Picture:
    shifted = [np.roll(picture.astype(np.float32), shift, axis) for shift in range(-pixels // 2, pixels // 2)]
    return _bytes(np.mean(shifted, axis=0))


def _plain(scene: Scene, _: np.random.Generator, *, colour: object) -> Picture:
    return _bytes(_flat(scene, colour))


def _grain(scene: Scene, rng: np.random.Generator, *, level: float, sd: float) -> Picture:
    return _noisy(_flat(scene, level), sd, rng)


def _elsewhere(scene: Scene, _: np.random.Generator, *, name: str) -> Picture:
    return _fitted(scene.others[name], scene)


def _lost_part(
    scene: Scene,
    _: np.random.Generator,
    *,
    rows: tuple[float, float],
    columns: tuple[float, float],
    colour: object,
) -> Spoiled:
    return _part(scene, rows, columns, colour)


def _vignette(scene: Scene, level: float) -> NDArray[np.float64]:
    v, u = _places(scene)
    return (level * (1 - 0.3 * (u**2 + v**2)))[..., None] * np.ones(3)


def _checker(scene: Scene, size: int) -> Picture:
    height, width = scene.image.shape[:2]
    on = (np.arange(height)[:, None] // size + np.arange(width) // size) % 2
    return _bytes(np.repeat(40 + 170 * on[..., None], 3, axis=2).astype(float))


def _bars(scene: Scene) -> Picture:
    colours = np.array([[w * 180 for w in ((n >> 2) & 1, (n >> 1) & 1, n & 1)] for n in range(8)])
    width = scene.image.shape[1]
    return np.broadcast_to(colours[np.arange(width) * 8 // width].astype(np.uint8), scene.image.shape).copy()


def _floor_everywhere(scene: Scene) -> Picture:
    """Patches of the floor, from below the middle of the view, side by side."""
    height, width = scene.image.shape[:2]
    patch = scene.image[3 * height // 4 :, width // 4 : 3 * width // 4]
    patch = np.concatenate([patch, patch[:, ::-1]], axis=1)
    patch = np.concatenate([patch, patch[::-1]], axis=0)
    times = (-(-height // patch.shape[0]), -(-width // patch.shape[1]), 1)
    return np.tile(patch, times)[:height, :width]


def _zoomed(scene: Scene, factor: float) -> Picture:
    height, width = scene.image.shape[:2]
    if factor > 1:
        h, w = int(height / factor), int(width / factor)
        top, left = (height - h) // 2, (width - w) // 2
        return _fitted(scene.image[top : top + h, left : left + w], scene)
    pad = ((int(height * (1 / factor - 1) / 2),) * 2, (int(width * (1 / factor - 1) / 2),) * 2, (0, 0))
    return _fitted(np.pad(scene.image, pad, "reflect"), scene)


def _poster(scene: Scene, size: float, angle_deg: float, rng: np.random.Generator) -> Picture:
    """The scene itself, printed, on a grey wall that fills the view."""
    wall = Image.fromarray(_noisy(_vignette(scene, 150.0), 3.0, rng))
    height, width = scene.image.shape[:2]
    small = Image.fromarray(scene.image).resize((int(width * size), int(height * size)))
    mask = Image.new("L", small.size, 255).rotate(angle_deg, expand=True)
    turned = small.rotate(angle_deg, Image.Resampling.BILINEAR, expand=True)
    wall.paste(turned, ((width - turned.width) // 2, (height - turned.height) // 2), mask)
    return np.asarray(wall)


def _blocks_shuffled(scene: Scene, rng: np.random.Generator) -> Picture:
    height, width = scene.image.shape[:2]
    image = scene.image.copy()
    places = [(v, u) for v in range(0, height - 31, 32) for u in range(0, width - 31, 32)]
    for (v, u), index in zip(places, rng.permutation(len(places)), strict=True):
        a, b = places[index]
        image[v : v + 32, u : u + 32] = scene.image[a : a + 32, b : b + 32]
    return image


def _part(scene: Scene, rows: tuple[float, float], columns: tuple[float, float], colour: object) -> Spoiled:
    height, width = scene.image.shape[:2]
    lost = np.zeros((height, width), np.bool_)
    lost[int(rows[0] * height) : int(rows[1] * height), int(columns[0] * width) : int(columns[1] * width)] = 1
    image = scene.image.copy()
    image[lost] = np.asarray(colour, np.uint8)
    return Spoiled(image, lost)


def _stripes(scene: Scene, axis: int, period: int) -> Spoiled:
    lost = np.zeros(scene.image.shape[:2], np.bool_)
    on = np.arange(lost.shape[axis]) % period < period // 2
    lost[on if axis == 0 else slice(None), slice(None) if axis == 0 else on] = True
    image = scene.image.copy()
    image[lost] = 0
    return Spoiled(image, lost)


def _macroblocks(scene: Scene, rng: np.random.Generator) -> Spoiled:
    height, width = scene.image.shape[:2]
    gone = rng.random((-(-height // 16), -(-width // 16))) < 0.4
    lost = np.repeat(np.repeat(gone, 16, 0), 16, 1)[:height, :width]
    image = scene.image.copy()
    image[lost] = 128
    return Spoiled(image, lost)


def _covered(scene: Scene, mask: NDArray[np.floating], colour: object) -> Spoiled:
    """Something before the lens, with soft edges: (H, W) mask in [0, 1]."""
    weight = mask[..., None]
    return Spoiled(_bytes(scene.image * (1 - weight) + np.asarray(colour, float) * weight), mask > 0.7)


def _glare(scene: Scene, v0: float, u0: float) -> Spoiled:
    v, u = _places(scene)
    light = 500 * np.exp(-((v - v0) ** 2 + (u - u0) ** 2) / 0.18)
    image = scene.image + light[..., None]
    return Spoiled(_bytes(image), light > 200)


def _drops(scene: Scene, rng: np.random.Generator) -> Spoiled:
    """Thirty drops: each shows the scene upside down and blurred."""
    v, u = _places(scene)
    mask = np.zeros(v.shape)
    for y, x, r in zip(
        rng.uniform(-1, 1, 30), rng.uniform(-1, 1, 30), rng.uniform(0.03, 0.12, 30), strict=True
    ):
        mask = np.maximum(mask, ((v - y) ** 2 + (u - x) ** 2 < r**2).astype(float))
    inside = _blurred(np.ascontiguousarray(scene.image[::-1]), 6)
    return Spoiled(_bytes(scene.image * (1 - mask[..., None]) + inside * mask[..., None]), mask > 0.7)


def _torn(scene: Scene, rows: tuple[float, ...], pixels: int) -> Picture:
    image, height = scene.image.copy(), scene.image.shape[0]
    for row in rows:
        image[int(row * height) :] = np.roll(image[int(row * height) :], pixels, axis=1)
    return image


def _without(scene: Scene, channel: int) -> Picture:
    image = scene.image.copy()
    image[..., channel] = 0
    return image


def _jpeg(picture: Picture, quality: int) -> Picture:
    file = BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=quality)
    return np.asarray(Image.open(file))


def _half_of_later(scene: Scene) -> Spoiled:
    half = scene.image.shape[0] // 2
    image = scene.image.copy()
    image[half:] = scene.later[half:]
    return Spoiled(image)


def _interlaced(scene: Scene) -> Picture:
    image = scene.image.copy()
    image[::2] = scene.later[::2]
    return image


def _swapped(scene: Scene) -> Picture:
    half = scene.image.shape[0] // 2
    return np.concatenate([scene.image[half:], scene.image[:half]])


def _doubled(scene: Scene) -> Picture:
    half = scene.image.shape[0] // 2
    image = scene.image.copy()
    image[half : 2 * half] = image[:half]
    return image


def _fog(scene: Scene, contrast: float, colour: object) -> Picture:
    return _bytes(scene.image * contrast + np.asarray(colour, float) * (1 - contrast))


def _nothing() -> None:
    for name, colour in {
        "black": 0,
        "grey 128": 128,
        "grey 160": 160,
        "white": 255,
        "green": (0, 200, 0),
        "dark green": (30, 90, 40),
        "blue": (20, 30, 220),
        "brown": (110, 80, 60),
    }.items():
        _add(name, "nothing", partial(_plain, colour=colour))
    for level, sd in ((4, 2.0), (6, 8.0), (128, 3.0), (128, 12.0), (160, 3.0), (250, 4.0)):
        name = f"level {level} with sensor noise {sd:g}"
        _add(name, "nothing", partial(_grain, level=level, sd=sd))
    _add("the floor's median", "nothing", lambda s, r: _bytes(_flat(s, _floor_colour(s))))
    _add("the floor's median, noise", "nothing", lambda s, r: _noisy(_flat(s, _floor_colour(s)), 4.0, r))
    _add("the picture's mean", "nothing", lambda s, r: _bytes(_flat(s, s.image.mean((0, 1)))))
    _add("grey wall, vignette", "nothing", lambda s, r: _bytes(_vignette(s, 150)))
    _add("grey wall, vignette, noise", "nothing", lambda s, r: _noisy(_vignette(s, 150), 3.0, r))
    _add(
        "floor-coloured wall, vignette",
        "nothing",
        lambda s, r: _noisy(_vignette(s, 1.0) * _floor_colour(s), 3.0, r),
    )
    _add("bright above, dark below", "nothing", lambda s, r: _bytes(_flat(s, 130) - 80 * _rows(s)))
    _add("bright below, dark above", "nothing", lambda s, r: _bytes(_flat(s, 130) + 80 * _rows(s)))
    _add("night, 5 % of the light", "nothing", lambda s, r: _bytes(s.image * 0.05))
    _add("night, 5 % of the light, noise", "nothing", lambda s, r: _noisy(s.image * 0.05, 3.0, r))
    _add("fog, 10 % contrast", "nothing", lambda s, r: _fog(s, 0.1, 170))
    _add("fog of the floor's colour, 10 %", "nothing", lambda s, r: _fog(s, 0.1, _floor_colour(s)))
    _add("white-out, 5 % contrast", "nothing", lambda s, r: _fog(s, 0.05, 245))
    _add("far out of focus", "nothing", lambda s, r: _blurred(s.image, s.image.shape[0] / 6))
    _add("floor filling the view", "nothing", lambda s, r: _floor_everywhere(s))
    _add("floor filling the view, blurred", "nothing", lambda s, r: _blurred(_floor_everywhere(s), 5))
    _add("checkerboard, 8 pixels", "nothing", lambda s, r: _checker(s, 8))
    _add("checkerboard, 40 pixels", "nothing", lambda s, r: _checker(s, 40))
    _add("colour bars", "nothing", lambda s, r: _bars(s))
    _add("white noise", "nothing", lambda s, r: _bytes(r.uniform(0, 255, s.image.shape)))


def _rows(scene: Scene) -> NDArray[np.float64]:
    return _places(scene)[0][..., None]


def _not_there() -> None:
    _add("upside down", "not there", lambda s, r: np.ascontiguousarray(s.image[::-1, ::-1]))
    _add("flipped", "not there", lambda s, r: np.ascontiguousarray(s.image[::-1]))
    _add("on its side", "not there", lambda s, r: _fitted(np.ascontiguousarray(np.rot90(s.image)), s))
    _add("negative", "not there", lambda s, r: np.asarray(255 - s.image, np.uint8))
    _add("halves swapped", "not there", lambda s, r: _swapped(s))
    _add("upper half twice", "not there", lambda s, r: _doubled(s))
    _add("blocks shuffled", "not there", _blocks_shuffled)
    _add("poster on a wall", "not there", lambda s, r: _poster(s, 0.5, 0.0, r))
    _add("poster on a wall, tilted", "not there", lambda s, r: _poster(s, 0.8, 20.0, r))
    _add("another lens, 2 times as long", "not there", lambda s, r: _zoomed(s, 2.5))
    _add("another lens, half as long", "not there", lambda s, r: _zoomed(s, 0.4))
    _add(
        "a third of the picture too low",
        "not there",
        lambda s, r: np.roll(s.image, s.image.shape[0] // 3, axis=0),
    )
    for name in (
        "embedded",
        "arena",
        "corridor",
        "hallway",
        "kitti",
        "room",
        "icl_office_kt3",
        "gopro_max_path",
    ):
        _add(f"another place: {name}", "not there", partial(_elsewhere, name=name))


def _degraded() -> None:
    for name, rows, columns, colour in (
        ("lower half grey", (0.5, 1), (0, 1), 128),
        ("lower half black", (0.5, 1), (0, 1), 0),
        ("lower half green", (0.5, 1), (0, 1), (0, 135, 0)),
        ("lower third grey", (0.67, 1), (0, 1), 128),
        ("upper half grey", (0, 0.5), (0, 1), 128),
        ("left half black", (0, 1), (0, 0.5), 0),
        ("right half grey", (0, 1), (0.5, 1), 128),
    ):
        _add(name, "degraded", partial(_lost_part, rows=rows, columns=columns, colour=colour))
    _add("black stripes along", "degraded", lambda s, r: _stripes(s, 0, 32))
    _add("black stripes upright", "degraded", lambda s, r: _stripes(s, 1, 32))
    _add("macroblocks lost", "degraded", _macroblocks)
    _add("sun glare above", "degraded", lambda s, r: _glare(s, -0.4, 0.2))
    _add("sun glare on the floor", "degraded", lambda s, r: _glare(s, 0.6, -0.2))
    _add("rain drops", "degraded", _drops)
    _add("finger on the lens", "degraded", lambda s, r: _covered(s, _side(s), (150, 90, 80)))
    _add("dirt on the lens", "degraded", lambda s, r: _covered(s, _blots(s, r), (60, 50, 40)))
    _add("motion blur along", "degraded", lambda s, r: _motion(s.image, 24, 1))
    _add("motion blur upright", "degraded", lambda s, r: _motion(s.image, 24, 0))
    _add("torn once", "degraded", lambda s, r: _torn(s, (0.6,), s.image.shape[1] // 8))
    _add("torn twice", "degraded", lambda s, r: _torn(s, (0.4, 0.7), s.image.shape[1] // 10))
    _add("lower half of another frame", "degraded", lambda s, r: _half_of_later(s))
    _add("interlaced with another frame", "degraded", lambda s, r: _interlaced(s))
    _add("red lost", "degraded", lambda s, r: _without(s, 0))
    _add("green lost", "degraded", lambda s, r: _without(s, 1))
    _add("blue lost", "degraded", lambda s, r: _without(s, 2))
    _add("red and blue swapped", "degraded", lambda s, r: np.ascontiguousarray(s.image[..., ::-1]))
    _add("mirrored", "degraded", lambda s, r: np.ascontiguousarray(s.image[:, ::-1]))
    _add("fog, 40 % contrast", "degraded", lambda s, r: _fog(s, 0.4, 170))
    _add("three times the light", "degraded", lambda s, r: _bytes(s.image * 3.0))
    _add("a quarter of the light", "degraded", lambda s, r: _noisy(s.image * 0.25, 2.0, r))
    _add("noise of 25 levels", "degraded", lambda s, r: _noisy(s.image.astype(float), 25.0, r))
    _add("JPEG of quality 5", "degraded", lambda s, r: _jpeg(s.image, 5))


def _side(scene: Scene) -> NDArray[np.float64]:
    return 1 / (1 + np.exp((_places(scene)[1] + 0.3) / 0.05))


def _blots(scene: Scene, rng: np.random.Generator) -> NDArray[np.float64]:
    v, u = _places(scene)
    blots = [np.exp(-((v - y) ** 2 + (u - x) ** 2) / 0.02) for y, x in rng.uniform(-1, 1, (12, 2))]
    return np.asarray(np.clip(1.3 * np.max(blots, axis=0), 0, 1))


_nothing()
_not_there()
_degraded()
