"""Measures of uncertainty from samples of the probability of above, in bits."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

P_ABOVE = "p_above"
"""Name of the map of probabilities beside the obstacle scores."""

TINY = np.finfo(np.float32).tiny


@dataclass(frozen=True)
class Measures:
    """Per-pixel maps, each (h, w) float32; all but `p_above` in bits.

    Attributes:
        p_above: mean over the samples, in [0, 1].
        entropy: predictive entropy, of that mean, in [0, 1]: the method's obstacle score.
        expected_entropy: mean entropy of the samples, in [0, 1]: how ambiguous the appearance is.
        mutual_information: their difference, in [0, 1]: how new the appearance is.
        surprisal: `-log2 P(the side the pixel really is on)`, in [0, 126].
    """

    p_above: NDArray[np.float32]
    entropy: NDArray[np.float32]
    expected_entropy: NDArray[np.float32]
    mutual_information: NDArray[np.float32]
    surprisal: NDArray[np.float32]


def measures(p_above_samples: ArrayLike, above: NDArray[np.bool_]) -> Measures:
    """All measures of one frame (decomposition as in Depeweg et al. 2018, arXiv:1710.07283).

    Args:
        p_above_samples: (N, h, w), one map a dropout sample or tree, in [0, 1]; N = 1 is a single pass, with
            no mutual information.
        above: (h, w) the side that each pixel really is on.

    Raises:
        ValueError: if the shapes do not fit.
    """
    samples = np.asarray(p_above_samples, np.float32)
    if samples.ndim != 3 or len(samples) == 0 or samples.shape[1:] != above.shape:
        raise ValueError(f"samples {samples.shape} do not fit the sides {above.shape}; want (N, h, w)")
    p_above = samples.mean(axis=0)
    entropy = binary_entropy(p_above)
    expected_entropy = binary_entropy(samples).mean(axis=0)
    return Measures(
        p_above=p_above,
        entropy=entropy,
        expected_entropy=expected_entropy,
        mutual_information=np.maximum(entropy - expected_entropy, np.float32(0.0)),
        surprisal=surprisal(p_above, above),
    )


def binary_entropy(p: ArrayLike) -> NDArray[np.float32]:
    """Entropy of a yes with probability p, bits: float32 in [0, 1], exactly 0 at p = 0 and p = 1.

    Example:
        >>> float(binary_entropy(0.5))
        1.0
    """
    yes = np.asarray(p, np.float32)
    no = np.float32(1.0) - yes
    bits = -yes * np.log2(np.maximum(yes, TINY)) - no * np.log2(np.maximum(no, TINY))
    clipped: NDArray[np.float32] = np.clip(bits, np.float32(0.0), np.float32(1.0))
    return clipped


def p_of_entropy(entropy: float) -> float:
    """The p in [0, 1/2] of a binary entropy in bits.

    Example:
        >>> round(p_of_entropy(0.4690), 3)
        0.1
    """
    p = np.linspace(1e-6, 0.5, 20001)
    return float(np.interp(entropy, -p * np.log2(p) - (1 - p) * np.log2(1 - p), p))


def log_odds(p: ArrayLike, least: float) -> NDArray[Any]:
    """Log odds, nats, of probabilities that are kept `least` from 0 and 1; float32 stays so.

    Example:
        >>> log_odds([0.0, 0.5, 1.0], 0.1).round(2).tolist()
        [-2.2, 0.0, 2.2]
    """
    kept = np.clip(np.asarray(p), least, 1.0 - least)
    return np.asarray(np.log(kept / (1.0 - kept)))


def p_other_side(p_above: NDArray[np.float32], above: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Probability of the side that the pixel is not on: orders pixels as the surprisal does, in [0, 1]."""
    return np.where(above, np.float32(1.0) - p_above, p_above)


def surprisal(p_above: NDArray[np.float32], above: NDArray[np.bool_]) -> NDArray[np.float32]:
    """`-log2 P(the side the pixel really is on)`, bits: float32, 126 where that side was ruled out."""
    right_side = np.where(above, p_above, np.float32(1.0) - p_above)
    return np.float32(0.0) - np.log2(np.maximum(right_side, TINY))
