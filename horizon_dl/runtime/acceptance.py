"""May this model file be used, and may it be flown? Asked of what is loaded, and of what comes in flight."""

import math
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.place import Place
from horizon_dl.geometry.camera import Camera

LEAST_VARIATION = 1e-3
"""A net whose `p_above` varies by less, over noise and flat colours, says the same of everything."""
FLAT_LEVELS = (0, 96, 208)


class TriedModel(Protocol):
    """What is needed of a model to try it."""

    camera: Camera
    place: Place | None

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Any:
        """Its maps."""


def checked_threshold(card: Mapping[str, Any]) -> float:
    """The threshold of a card, bits; ValueError where it is no number in (0, 1]."""
    value = card["threshold"]["value"]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("its threshold is no number")
    if not (math.isfinite(value) and 0 < value <= 1):
        raise ValueError(f"its threshold of {value:g} bit is not in (0, 1]")
    return float(value)


def checked_size(card: Mapping[str, Any]) -> tuple[int, int]:
    """(w, h), the working size of a card; ValueError where it is none."""
    size = card["working_size"]
    good = isinstance(size, list) and len(size) == 2 and all(type(side) is int and side > 0 for side in size)
    if not good:
        raise ValueError("its working size is no pair of numbers")
    return size[0], size[1]


def checked_place(card: Mapping[str, Any]) -> Place | None:
    """The evidence limits of a card, None where it has none; ValueError for damaged ones."""
    found = card.get("evidence")
    return None if found is None else Place.from_card(found)


def smoke_test(model: TriedModel) -> str | None:
    """What is wrong with the maps that a model gives for made-up pictures, or None.

    Noise and three flat colours: every `p_above` and entropy must be a number in [0, 1], and a net that says
    the same of all of them has learned nothing.
    """
    shape = (model.camera.height, model.camera.width, 3)
    noise = np.random.default_rng(0).integers(0, 256, shape).astype(np.uint8)
    pictures = [noise, *(np.full(shape, level, np.uint8) for level in FLAT_LEVELS)]
    maps = [model.predict(picture, (0.0, -1.0, 0.0)) for picture in pictures]
    for name in ("p_above", "entropy"):
        values = np.stack([getattr(found, name) for found in maps])
        if not (np.isfinite(values).all() and values.min() >= -1e-3 and values.max() <= 1 + 1e-3):
            return f"gives no {name} in [0, 1]"
        if name == "p_above" and float(values.max() - values.min()) < LEAST_VARIATION:
            return "says the same of every picture"
    return None


def not_airworthy(model: TriedModel, limits: EvidenceLimits = LIMITS) -> str | None:
    """Why a model is not to be flown, or None: limits for its evidence, and a net that learned enough."""
    if model.place is None:
        return "was exported without limits for its evidence"
    accuracy = model.place.horizon_accuracy
    if accuracy < limits.least_trained_accuracy:
        return (
            f"tells above from below with {accuracy:.0%} on its own training pictures, "
            f"under {limits.least_trained_accuracy:.0%}: it has learned too little"
        )
    return None
