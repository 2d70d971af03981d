"""Entropies as tensor operations of the deployed graph."""

from math import log

import numpy as np
from torch import Tensor

TINY = float(np.finfo(np.float32).tiny)
BITS = 1 / log(2)


def surprisal_of(p: Tensor) -> Tensor:
    """-log2 p; at most 126 bits, and never negative where rounding made p a little more than one."""
    return p.clamp(TINY, 1.0).log() * -BITS


def entropy(p: Tensor) -> Tensor:
    """Of a yes with probability p, bits; zero where p is 0 or 1."""
    return p * surprisal_of(p) + (1 - p) * surprisal_of(1 - p)
