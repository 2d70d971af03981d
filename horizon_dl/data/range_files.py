"""Range images: distances as counts of 16 bits or as floats, and how they lie to their pictures."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.images import load_uint16
from horizon_dl.data.regular_file import check_regular
from horizon_dl.errors import FrameError


def load_metres(path: Path, metres_a_count: float) -> NDArray[np.float32]:
    """(h, w) distances of a range image: 16-bit counts, or metres as floats in an .npy file; NaN for none.

    Raises:
        FrameError: it cannot be read.
    """
    if path.suffix == ".npy":
        metres = load_array(path).astype(np.float32)
        if metres.ndim != 2:
            raise FrameError(path, f"has {metres.ndim} dimensions", "store one distance a pixel")
        return np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(np.nan))
    counts = load_uint16(path)
    none = (counts == 0) | (counts == np.iinfo(np.uint16).max)
    return np.where(none, np.nan, counts * np.float32(metres_a_count)).astype(np.float32)


def load_array(path: Path) -> NDArray[np.float64]:
    """The numbers in an .npy file, of any shape.

    Raises:
        FrameError: it cannot be read, holds no real numbers, or fewer than its header says.
    """
    try:
        check_regular(path)
        # Mapped, what the header promises is compared with the file's size before any memory is taken.
        stored = np.load(path, mmap_mode="r", allow_pickle=False)
        if isinstance(stored, np.ndarray) and stored.dtype.kind in "buif":
            return np.array(stored, np.float64)
    except Exception:  # numpy reads headers with Python's own tokenizer, and lets its errors through
        pass
    raise FrameError(path, "cannot be read as an array of numbers", "restore the file")


def lies_as(shape: tuple[int, ...], stored: tuple[int, ...]) -> bool:
    """Whether a range image lies as its stored image does, and has to be turned with it.

    One that was saved upright, as labels are, betrays itself by its sides after a quarter turn.

    Example:
        >>> lies_as((120, 160), (240, 320)), lies_as((160, 120), (240, 320))
        (True, False)
    """
    return (shape[0] < shape[1]) == (stored[0] < stored[1])
