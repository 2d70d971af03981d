"""Colours of maps and truths, as lookup tables of 256 entries; no plotting library needed."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from horizon_dl.data.frame import Truth
from horizon_dl.evidence.sketch import luma

Colour = tuple[int, int, int]
Image = NDArray[np.uint8]

ABOVE_COLOUR: Colour = (33, 102, 172)
BELOW_COLOUR: Colour = (107, 142, 35)
OBSTACLE_COLOUR: Colour = (230, 74, 25)
HORIZON_COLOUR: Colour = (255, 214, 10)
HEADING_COLOUR: Colour = (64, 156, 255)
NO_VALUE_COLOUR: Colour = (222, 222, 222)
UNKNOWN_COLOUR: Colour = (128, 132, 140)

# Control points every 1/16 of matplotlib's "magma" (CC0): within 3 of 255 of the full table.
_MAGMA: tuple[Colour, ...] = (
    (0, 0, 4),
    (10, 8, 34),
    (29, 17, 71),
    (54, 16, 107),
    (81, 18, 124),
    (106, 28, 129),
    (131, 38, 129),
    (156, 46, 127),
    (183, 55, 121),
    (207, 64, 112),
    (229, 80, 100),
    (244, 105, 92),
    (251, 135, 97),
    (254, 165, 113),
    (254, 194, 135),
    (253, 224, 161),
    (252, 253, 191),
)
# Below the horizon olive, undecided nearly white, above blue: lightness is symmetric about the middle.
_SIDES: tuple[Colour, ...] = (
    (66, 92, 16),
    (107, 142, 35),
    (172, 196, 116),
    (247, 247, 243),
    (146, 190, 222),
    (51, 120, 186),
    (16, 66, 124),
)
_TABLES = {"uncertainty": _MAGMA, "sides": _SIDES}
TRUTH_COLOURS: dict[Truth, Colour] = {
    Truth.FLOOR: BELOW_COLOUR,
    Truth.OBSTACLE: OBSTACLE_COLOUR,
    Truth.ABOVE: ABOVE_COLOUR,
}


@lru_cache
def lookup_table(name: str) -> Image:
    """(256, 3) uint8 RGB of the colour map `uncertainty` (dark to light) or `sides` (below to above)."""
    points = np.asarray(_TABLES[name], np.float64)
    stops = np.linspace(0, 255, len(points))
    channels = [np.interp(np.arange(256), stops, points[:, channel]) for channel in range(3)]
    return np.stack(channels, axis=1).round().astype(np.uint8)


def colour_map(values: NDArray[np.floating], name: str) -> Image:
    """Values in [0, 1] as an RGB image of the same size; values beyond are clipped, NaN is light grey.

    Args:
        values: (h, w).
        name: `uncertainty` for entropies and other scores, `sides` for `p_above`.

    Returns:
        (h, w, 3) uint8 RGB.
    """
    missing = np.isnan(values)
    indices = (np.clip(np.where(missing, 0.0, values), 0.0, 1.0) * 255).round().astype(np.uint8)
    coloured = lookup_table(name)[indices]
    coloured[missing] = NO_VALUE_COLOUR
    return coloured


def tint(image: Image, mask: NDArray[np.bool_], colour: Colour, strength: float) -> Image:
    """A copy of the (h, w, 3) image with the masked pixels mixed with a colour, strength in [0, 1]."""
    levels = np.arange(256) * (1.0 - strength) + np.asarray(colour)[:, None] * strength
    picture = PilImage.fromarray(image)
    picture.paste(picture.point(levels.round().ravel().tolist()), mask=PilImage.fromarray(mask))
    return np.array(picture)


def grey(image: Image) -> Image:
    """The (h, w, 3) image without its colour, slightly lifted, as a ground for overlays."""
    return np.repeat((40 + luma(image) * 0.8).round().astype(np.uint8)[..., None], 3, axis=2)
