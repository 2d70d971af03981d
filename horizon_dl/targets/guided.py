"""The horizon label spread over the image's surfaces by a guided filter."""

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage

from horizon_dl.targets.hard import hard_target


def guided_target(
    image: NDArray[np.uint8],
    elevation: NDArray[np.float32],
    reach_vertical: float = 0.42,
    reach_sideways: float = 0.15,
    eps: float = 0.005,
    statistics_rows: int = 120,
) -> NDArray[np.float32]:
    """The hard label, filtered with the colour image as guide (He et al. 2013, eq. 14 to 16).

    Within a window the label becomes a linear function of the colour, so a wall that crosses the horizon gets
    a mixed target, and a floor whose colour is seen only below keeps its own.

    Args:
        image: (h, w, 3) uint8 RGB.
        elevation: (h, w) rad, NaN where the ray is not valid.
        reach_vertical: how far the window reaches up and down, in image heights.
        reach_sideways: how far it reaches left and right, in image heights.
        eps: colour variance (colours in [0, 1]) below which a window counts as flat.
        statistics_rows: window statistics are taken on every n-th pixel, so that at least this many rows and
            columns remain; the result is full size. More is slower and hardly different.

    Returns:
        (h, w) float32 in [0, 1], 1 above; NaN where the elevation is NaN.
    """
    from kornia.filters import guided_blur  # slow to load, and the default target needs none of it

    label = _fill_from_nearest(hard_target(image, elevation))
    if label is None:
        return np.full(elevation.shape, np.nan, np.float32)
    guide = torch.tensor(image.copy(), dtype=torch.float32).permute(2, 0, 1)[None] / 255.0
    step = max(1, min(elevation.shape) // statistics_rows)
    kernel = _window(elevation.shape, reach_vertical, reach_sideways, step)
    spread = guided_blur(
        guide, torch.from_numpy(label)[None, None], kernel, eps, subsample=step, separable=True
    )
    target = spread[0, 0].clamp(0.0, 1.0).numpy()
    return np.where(np.isnan(elevation), np.float32(np.nan), target)


def _window(shape: tuple[int, ...], vertical: float, sideways: float, step: int) -> tuple[int, int]:
    """Window (rows, columns), odd on the grid of every `step`-th pixel, within what a border can mirror."""
    rows = min(round(vertical * shape[0] / step), shape[0] // step - 1)
    columns = min(round(sideways * shape[0] / step), shape[1] // step - 1)
    return 2 * rows * step + 1, 2 * columns * step + 1


def _fill_from_nearest(label: NDArray[np.float32]) -> NDArray[np.float32] | None:
    """Fills NaN with the nearest known label, as the filter knows no gaps; None if nothing is known."""
    unknown = np.isnan(label)
    if unknown.all():
        return None
    if not unknown.any():
        return label
    nearest = ndimage.distance_transform_edt(unknown, return_distances=False, return_indices=True)
    filled: NDArray[np.float32] = label[tuple(nearest)]
    return filled
