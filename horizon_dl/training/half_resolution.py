"""Training frames: targets at half the size, and where they count.

The net judges at a quarter of the image's size, and diffusion at half the size takes a quarter of the time.
"""

from collections.abc import Callable
from dataclasses import dataclass
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
from horizon_dl.targets.taught import taught_target
from horizon_dl.training.crops import TrainingFrame

T = TypeVar("T", bound=np.generic)
Map = NDArray[np.float32]
Guide = Callable[[NDArray[np.uint8], tuple[int, ...]], Map]


@dataclass(frozen=True)
class Teacher:
    """A net whose opinion has a share of the targets.

    Attributes:
        says: what it says of an image at a size.
        share: in [0, 1].
    """

    says: Guide
    share: float


def guide_of(net: HorizonFCN) -> Guide:
    """What a net says of any image: the mean over the heads at all its depths."""
    return lambda image, size: EncodedImage(net, image).of_all_depths(size)


def half_resolution_target(
    image: NDArray[np.uint8],
    elevation: Map,
    config: Config,
    guide: Guide | None,
    teacher: Teacher | None = None,
) -> NDArray[np.float16]:
    """The target of an image, made at half its size.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h // 2, w // 2) rad, as of `halved`.
        config: names the kind of target.
        guide: gives what a net says of an image at a size; the target follows it, too. None: the image alone.
        teacher: has a share of the target below the horizon, see `taught_target`.

    Returns:
        (h, w) in [0, 1]; 0 where nothing is known.
    """
    size = elevation.shape
    small = View(area_resize(image, (size[1], size[0])), elevation)
    p_above = None if guide is None else guide(image, size)
    target = make_target(config.target.kind, small, p_above, config.geodesic)
    if teacher is not None:
        target = taught_target(target, elevation, teacher.says(image, size), teacher.share)
    return doubled(np.nan_to_num(target).astype(np.float16), image.shape[:2])


def doubled(target: NDArray[T], size: tuple[int, ...]) -> NDArray[T]:
    """A map of half the size at the whole `size` (h, w), each pixel four times; edges are repeated."""
    twice = target.repeat(2, axis=0).repeat(2, axis=1)
    missing = [(0, whole - double) for whole, double in zip(size, twice.shape, strict=True)]
    return np.pad(twice, missing, mode="edge")


def half_resolution_frame(
    view: View, config: Config, guide: Guide | None, teacher: Teacher | None = None
) -> TrainingFrame:
    """A view with its target, and where it counts; `guide` and `teacher` as for `half_resolution_target`."""
    target = half_resolution_target(view.image, halved(view.elevation), config, guide, teacher)
    valid_mask = labelled_pixels(view.elevation, config.labels.band_rad)
    return TrainingFrame(view.image, target, valid_mask)
