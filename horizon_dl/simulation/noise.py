"""Periodic value noise, the base of every procedural texture."""

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float32]


def _lattice(size: int, cells: int) -> tuple[NDArray[np.intp], NDArray[np.intp], Field]:
    position = (np.arange(size) + 0.5) * cells / size
    low = np.floor(position).astype(np.intp)
    fraction = (position - low).astype(np.float32)
    smooth = fraction * fraction * (3 - 2 * fraction)
    return low % cells, (low + 1) % cells, smooth.astype(np.float32)


def value_noise(rng: np.random.Generator, height: int, width: int, cells: tuple[int, int]) -> Field:
    """Smooth random field in [0, 1], periodic in both directions.

    Args:
        rng: source of randomness.
        height: rows.
        width: columns.
        cells: lattice cells (down, across); more cells, finer grain.

    Returns:
        (height, width) float32.
    """
    grid = rng.random(cells, dtype=np.float32)
    top, bottom, down = _lattice(height, cells[0])
    left, right, across = _lattice(width, cells[1])
    rows = grid[top] * (1 - down[:, None]) + grid[bottom] * down[:, None]
    return np.asarray(rows[:, left] * (1 - across) + rows[:, right] * across, np.float32)


def fractal_noise(
    rng: np.random.Generator, height: int, width: int, cells: tuple[int, int], octaves: int = 4
) -> Field:
    """Sum of octaves of `value_noise`, each twice as fine and half as strong, with mean about 0.

    Returns:
        (height, width) float32, about -1 to 1.
    """
    total: Field = np.zeros((height, width), np.float32)
    for octave in range(octaves):
        fine = (min(cells[0] << octave, height), min(cells[1] << octave, width))
        total += (value_noise(rng, height, width, fine) - 0.5) * 0.5**octave
    return total
