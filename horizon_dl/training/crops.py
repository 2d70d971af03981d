"""Training frames, and batches of crops from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from horizon_dl.config import Config
from horizon_dl.data.view import View
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.targets.targets import make_target


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


def training_frame(view: View, config: Config, p_above: NDArray[np.float32] | None = None) -> TrainingFrame:
    """The target of a view, and where it counts; see `make_target` for `p_above`."""
    target = make_target(config.target.kind, view, p_above)
    valid_mask = labelled_pixels(view.elevation, config.labels.band_rad)
    return TrainingFrame(view.image, np.nan_to_num(target).astype(np.float16), valid_mask)


class Batch(NamedTuple):
    """Crops to learn from: images (N, 3, c, c) in [0, 1], targets and weights (N, 1, c, c) in [0, 1]."""

    images: Tensor
    targets: Tensor
    weights: Tensor


def draw_batch(frames: Sequence[TrainingFrame], crop: int, rng: np.random.Generator) -> Batch:
    """One random crop of each frame, mirrored at random; crops shrink to frames that are smaller."""
    height = min(crop, *(frame.image.shape[0] for frame in frames))
    width = min(crop, *(frame.image.shape[1] for frame in frames))
    crops = [_crop(frame, height, width, rng) for frame in frames]
    images, targets, valid_mask = (np.stack(part) for part in zip(*crops, strict=True))
    return Batch(
        torch.from_numpy(images).permute(0, 3, 1, 2).float() / 255.0,
        torch.from_numpy(targets)[:, None].float(),
        torch.from_numpy(valid_mask)[:, None].float(),
    )


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
