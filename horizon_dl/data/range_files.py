"""Range images: distances as counts of 16 bits or as floats, and how they lie to their pictures."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.images import load_uint16
from horizon_dl.errors import FrameError


def load_metres(path: Path, metres_a_count: float) -> NDArray[np.float32]:
    """(h, w) distances of a range image: 16-bit counts, or metres as floats in an .npy file; NaN for none.

    Raises:
        FrameError: it cannot be read.
    """
    if path.suffix == ".npy":
        try:
            metres = np.asarray(np.load(path, allow_pickle=False), np.float32)
        except (OSError, ValueError, EOFError):
            raise FrameError(path, "cannot be read as an array", "restore the file") from None
        if metres.ndim != 2:
            raise FrameError(path, f"has {metres.ndim} dimensions", "store one distance a pixel")
        return np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(np.nan))
    counts = load_uint16(path)
    none = (counts == 0) | (counts == np.iinfo(np.uint16).max)
    return np.where(none, np.nan, counts * np.float32(metres_a_count)).astype(np.float32)


def lies_as(shape: tuple[int, ...], stored: tuple[int, ...]) -> bool:
    """Whether a range image lies as its stored image does, and has to be turned with it.

    One that was saved upright, as labels are, betrays itself by its sides after a quarter turn.

    Example:
        >>> lies_as((120, 160), (240, 320)), lies_as((160, 120), (240, 320))
        (True, False)
    """
    return (shape[0] < shape[1]) == (stored[0] < stored[1])
