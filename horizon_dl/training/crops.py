"""Training frames, and batches of crops from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

PASTE_SIDES = (0.33, 0.83)
"""Least and largest side of a pasted piece, in sides of the crop. Chosen on room and KITTI."""


@dataclass(frozen=True)
class TrainingFrame:
    """What is kept of a frame to learn from it.

    Attributes:
        image: (h, w, 3) uint8 RGB.
        target: (h, w) float16 in [0, 1]; 0 where it does not count.
        valid_mask: (h, w) bool, false in the ignore band and where there is no ray.
    """

    image: NDArray[np.uint8]
    target: NDArray[np.float16]
    valid_mask: NDArray[np.bool_]

    @property
    def nbytes(self) -> int:
        """Bytes held."""
        return self.image.nbytes + self.target.nbytes + self.valid_mask.nbytes


class Batch(NamedTuple):
    """Crops to learn from: images (N, 3, c, c) in [0, 1], targets and weights (N, 1, c, c) in [0, 1]."""

    images: Tensor
    targets: Tensor
    weights: Tensor


def draw_batch(
    frames: Sequence[TrainingFrame], crop: int, rng: np.random.Generator, pastes: int = 0
) -> Batch:
    """One random crop of each frame, mirrored at random; crops shrink to frames that are smaller.

    Args:
        frames: one for each crop.
        crop: height and width, pixels.
        rng: of places and mirrors.
        pastes: pieces of the batch's crops that are pasted into each, see `_paste_pieces`.
    """
    height = min(crop, *(frame.image.shape[0] for frame in frames))
    width = min(crop, *(frame.image.shape[1] for frame in frames))
    crops = [_crop(frame, height, width, rng) for frame in frames]
    images, targets, valid_mask = (np.stack(part) for part in zip(*crops, strict=True))
    if pastes:
        _paste_pieces((images, targets, valid_mask), pastes, rng)
    return Batch(
        torch.from_numpy(images).permute(0, 3, 1, 2).float() / 255.0,
        torch.from_numpy(targets)[:, None].float(),
        torch.from_numpy(valid_mask)[:, None].float(),
    )


def _paste_pieces(parts: Sequence[NDArray[Any]], pastes: int, rng: np.random.Generator) -> None:
    """Paste pieces of the crops of a batch into each other, at random places, together with their targets.

    What surrounds a pixel then says little about where in the scene it lies, so that a net with a wide view
    has to judge by what the pixel belongs to (CutMix, Yun et al. 2019, arXiv:1905.04899, pixel by pixel).

    Args:
        parts: arrays (N, h, w, ...) that belong together; changed in place.
        pastes: pieces a crop.
        rng: of crops, sizes and places.
    """
    before = [part.copy() for part in parts]
    count, *shape = parts[0].shape[:3]
    for number in range(count):
        for source in rng.integers(count, size=pastes):
            sides = [max(1, round(side * rng.uniform(*PASTE_SIDES))) for side in shape]
            new, old = (_place(shape, sides, rng) for _ in range(2))
            for part, origin in zip(parts, before, strict=True):
                part[(number, *new)] = origin[(source, *old)]


def _place(shape: Sequence[int], sides: Sequence[int], rng: np.random.Generator) -> tuple[slice, slice]:
    """Rows and columns of a random rectangle of that size in a picture of that shape."""
    top, left = (int(rng.integers(whole - side + 1)) for whole, side in zip(shape, sides, strict=True))
    return slice(top, top + sides[0]), slice(left, left + sides[1])


def _crop(
    frame: TrainingFrame, height: int, width: int, rng: np.random.Generator
) -> tuple[NDArray[np.uint8], NDArray[np.float16], NDArray[np.bool_]]:
    top = rng.integers(frame.image.shape[0] - height + 1)
    left = rng.integers(frame.image.shape[1] - width + 1)
    rows, columns = slice(top, top + height), slice(left, left + width)
    step = -1 if rng.random() < 0.5 else 1
    return (
        frame.image[rows, columns][:, ::step],
        frame.target[rows, columns][:, ::step],
        frame.valid_mask[rows, columns][:, ::step],
    )
