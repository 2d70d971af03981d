"""Training frames: targets at half the size, and where they count.

The net judges at a quarter of the image's size, and diffusion at half the size takes a quarter of the time.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.data.view import View
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.geometry.resize import area_resize, halved
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.targets.targets import make_target
from horizon_dl.training.crops import TrainingFrame

T = TypeVar("T", bound=np.generic)
Map = NDArray[np.float32]
Guide = Callable[[NDArray[np.uint8], tuple[int, ...]], Map]


def guide_of(net: HorizonFCN) -> Guide:
    """What a net says of any image: the mean over the heads at all its depths."""
    return lambda image, size: EncodedImage(net, image).of_all_depths(size)


def half_resolution_target(
    image: NDArray[np.uint8], elevation: Map, config: Config, guide: Guide | None
) -> NDArray[np.float16]:
    """The target of an image, made at half its size.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h // 2, w // 2) rad, as of `halved`.
        config: names the kind of target.
        guide: gives what a net says of an image at a size; the target follows it, too. None: the image alone.

    Returns:
        (h, w) in [0, 1]; 0 where nothing is known.
    """
    size = elevation.shape
    small = View(area_resize(image, (size[1], size[0])), elevation)
    p_above = None if guide is None else guide(image, size)
    target = np.nan_to_num(make_target(config.target.kind, small, p_above, config.geodesic)).astype(
        np.float16
    )
    return doubled(target, image.shape[:2])


def doubled(target: NDArray[T], size: tuple[int, ...]) -> NDArray[T]:
    """A map of half the size at the whole `size` (h, w), each pixel four times; edges are repeated."""
    twice = target.repeat(2, axis=0).repeat(2, axis=1)
    missing = [(0, whole - double) for whole, double in zip(size, twice.shape, strict=True)]
    return np.pad(twice, missing, mode="edge")


def half_resolution_frame(view: View, config: Config, guide: Guide | None) -> TrainingFrame:
    """A view with its target, and where it counts; `guide` as for `half_resolution_target`."""
    target = half_resolution_target(view.image, halved(view.elevation), config, guide)
    valid_mask = labelled_pixels(view.elevation, config.labels.band_rad)
    return TrainingFrame(view.image, target, valid_mask)
