"""Can this exposure show anything? The one test of the package, for flight, learning and inspection."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.reason import Reason


def exposure_problem(grey: NDArray[Any], limits: EvidenceLimits = LIMITS) -> Reason | None:
    """Whether a picture shows nothing: (nearly) all black, all white, or one flat colour.

    Args:
        grey: (h, w) brightness in [0, 255]: of a sketch, or of the picture itself.
        limits: levels and shares.

    Example:
        >>> str(exposure_problem(np.zeros((48, 64))))
        'black'
    """
    if np.mean(grey < limits.dark_level) > limits.most_unusable:
        return Reason.DARK
    if np.mean(grey > limits.bright_level) > limits.most_unusable:
        return Reason.BRIGHT
    return Reason.FLAT if float(grey.std()) < limits.least_contrast else None
