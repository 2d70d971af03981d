"""Is this a familiar place? Ranges of the training pictures, and the colours that they had below the horizon.

Calibrated when a net is trained, kept in the card of its file.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.evidence.appearance import FEATURES, LEAST_RANGE, appearance
from horizon_dl.evidence.horizon_offset import horizon_offset
from horizon_dl.evidence.limits import LIMITS, EvidenceLimits
from horizon_dl.evidence.sectors import lost_pixels
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.usual_levels import UsualLevels
from horizon_dl.uncertainty.measures import p_of_entropy

LEVELS = 16
"""Of each channel; a colour is familiar if it or a neighbour among 16 x 16 x 16 was seen."""
RARE = 5e-5
"""Share of the training pixels below which a colour counts as never seen."""
OFTEN = 1e-3
"""Share of the training pixels from which on a colour is a usual one of flat ground. Not picked on data."""
LOG_RANGE = (-2.0, 8.0)
"""All that the logarithms of changes in grey levels can be."""
VERSION = 1


@dataclass(frozen=True)
class Place:
    """What the training pictures were like.

    Attributes:
        low: least of each of `FEATURES`.
        high: greatest of each.
        colours: (16, 16, 16) bool, familiar colours below the horizon.
        frames: how many pictures tell so.
        horizon_accuracy: of the net on them, mean; tells a net that has not learned enough.
        floor_p: `p_above` of the floor on them, median of the pictures' own floor levels; None in cards of
            before it was kept.
        offset_rad: between the horizons of net and attitude on them, least and greatest without a twentieth
            of the pictures on either side; None as of `floor_p`.
        flat: (16, 16, 16) bool, colours that ground without any change from pixel to pixel often had, as in
            films that a codec has smoothed; never black, nor with a full channel. None as of `floor_p`.
        obstacle_p: `p_above` that best parts obstacles from floor, see `UsualLevels`; None as of `floor_p`.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    colours: NDArray[np.bool_]
    frames: int
    horizon_accuracy: float
    floor_p: float | None = None
    offset_rad: tuple[float, float] | None = None
    flat: NDArray[np.bool_] | None = None
    obstacle_p: float | None = None

    def strangeness(self, features: NDArray[np.floating]) -> tuple[float, str]:
        """How far a picture lies outside of the ranges, in ranges, and by which feature; 0 inside.

        A feature that is not known (NaN) says nothing. A net that knows the horizon better than ever is
        not strange.
        """
        low, high = np.array(self.low), np.array(self.high)
        size = np.maximum(high - low, LEAST_RANGE)
        above = features - high
        above[FEATURES.index("horizon_accuracy")] = 0.0
        out = np.nan_to_num(np.maximum(np.maximum(low - features, above) / size, 0.0))
        worst = int(out.argmax())
        return float(out[worst]), FEATURES[worst]

    def least_horizon_accuracy(self, limits: EvidenceLimits = LIMITS) -> float:
        """Under this a net is worse than it ever was in training."""
        worst = self.low[FEATURES.index("horizon_accuracy")]
        return max(limits.least_horizon_accuracy, worst - limits.horizon_margin)

    def at_another_size(self) -> "Place":
        """For pictures of another size than those of the training: what depends on the size says nothing."""
        low, high = list(self.low), list(self.high)
        for name in ("fine", "coarse"):
            low[FEATURES.index(name)], high[FEATURES.index(name)] = LOG_RANGE
        return replace(self, low=tuple(low), high=tuple(high))

    def unfamiliar(self, image: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """(h, w) pixels of colours that were not seen below the horizon."""
        return ~_looked_up(self.colours, image)

    def usually_flat(self, image: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """(h, w) pixels of colours of which flat ground is nothing new."""
        return np.zeros(image.shape[:2], np.bool_) if self.flat is None else _looked_up(self.flat, image)

    def to_card(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "version": VERSION,
            "frames": self.frames,
            "horizon_accuracy": self.horizon_accuracy,
            "floor_p": self.floor_p,
            "obstacle_p": self.obstacle_p,
            "horizon_offset_rad": None if self.offset_rad is None else list(self.offset_rad),
            "ranges": {name: [a, b] for name, a, b in zip(FEATURES, self.low, self.high, strict=True)},
            "colours": _to_hex(self.colours),
            "flat": None if self.flat is None else _to_hex(self.flat),
        }

    @classmethod
    def from_card(cls, card: object) -> "Place":
        """Of `to_card`.

        Raises:
            ValueError: it holds something else.
        """
        if not isinstance(card, Mapping) or card.get("version") != VERSION:
            raise ValueError("has no evidence limits of this version")
        try:
            pairs = [card["ranges"][name] for name in FEATURES]
            ranges = np.array([[float(value) for value in pair] for pair in pairs])
            colours = _from_hex(card["colours"])
            flat = None if card.get("flat") is None else _from_hex(card["flat"])
            frames, accuracy = int(card["frames"]), float(card["horizon_accuracy"])
            levels = [card.get("floor_p"), card.get("obstacle_p")]
            floor_p, obstacle_p = (None if level is None else float(level) for level in levels)
            offset = card.get("horizon_offset_rad")
            offset = None if offset is None else (float(offset[0]), float(offset[1]))
        except (LookupError, TypeError, ValueError):
            raise ValueError("has damaged evidence limits") from None
        good = ranges.shape == (len(FEATURES), 2) and np.isfinite(ranges).all()
        good = good and 0 <= accuracy <= 1 and all(p is None or 0 <= p <= 1 for p in (floor_p, obstacle_p))
        good = good and (offset is None or -np.pi <= offset[0] <= offset[1] <= np.pi)
        if not good or (ranges[:, 0] > ranges[:, 1]).any() or frames < 1:
            raise ValueError("has damaged evidence limits")
        low, high = ranges.T.tolist()
        return cls(tuple(low), tuple(high), colours, frames, accuracy, floor_p, offset, flat, obstacle_p)


@dataclass
class PlaceCalibration:
    """Collects what `Place` needs, training picture by training picture.

    Attributes:
        limits: of the config.
        ranging: how the floor's level is taken, and where the ground begins.
    """

    limits: EvidenceLimits = LIMITS
    ranging: RangingParams = field(default_factory=RangingParams)
    _features: list[NDArray[np.float64]] = field(default_factory=list)
    _floors: list[float] = field(default_factory=list)
    _offsets: list[float] = field(default_factory=list)
    _counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(LEVELS**3, np.int64))
    _flat: NDArray[np.int64] = field(default_factory=lambda: np.zeros(LEVELS**3, np.int64))

    def add(
        self, image: NDArray[np.uint8], elevation: NDArray[np.floating], p_above: NDArray[np.floating]
    ) -> None:
        """One picture at the working size; see `appearance`."""
        self._features.append(appearance(image, elevation, p_above, self.limits))
        self._offsets.append(horizon_offset(p_above, elevation, self.limits))
        ground = p_above[elevation < -self.ranging.unseen_rad]
        if ground.size:
            self._floors.append(float(np.percentile(ground, self.ranging.rise.floor_percentile)))
        below = elevation < 0
        self._counts += _colour_counts(image[below])
        self._flat += _colour_counts(image[below & lost_pixels(image)])

    def place(self, obstacle_p: float | None = None) -> Place | None:
        """What was collected; None without a picture that shows both sides of the horizon.

        Args:
            obstacle_p: see `Place`.
        """
        if not self._features:
            return None
        features = np.stack(self._features)
        if np.isnan(features).all(axis=0).any():
            return None
        low, high = np.nanmin(features, axis=0), np.nanmax(features, axis=0)
        seen = self._counts > RARE * self._counts.sum()
        return Place(
            tuple(low.tolist()),
            tuple(high.tolist()),
            with_neighbours(seen),
            len(features),
            float(np.nanmean(features[:, FEATURES.index("horizon_accuracy")])),
            float(np.median(self._floors)) if self._floors else None,
            (float(np.nanpercentile(self._offsets, 5)), float(np.nanpercentile(self._offsets, 95))),
            self._usually_flat(),
            obstacle_p,
        )

    def _usually_flat(self) -> NDArray[np.bool_]:
        flat: NDArray[np.bool_] = (self._flat > OFTEN * self._counts.sum()).reshape(LEVELS, LEVELS, LEVELS)
        flat[:2, :2, :2] = False  # without light, video's black included, nothing is shown
        for overflown in (flat, flat.swapaxes(0, 1), flat.swapaxes(0, 2)):
            overflown[-1] = False  # nor where a channel is full
        return flat


def usual_levels(place: Place | None, threshold: float) -> UsualLevels:
    """What a learner usually says of the training pictures; of the floor else the most that it may have.

    Args:
        place: what the training pictures were like, where that was kept.
        threshold: the paper's, bits.
    """
    if place is None or place.floor_p is None:
        return UsualLevels(p_of_entropy(threshold))
    return UsualLevels(place.floor_p, place.obstacle_p)


def _looked_up(table: NDArray[np.bool_], image: NDArray[np.uint8]) -> NDArray[np.bool_]:
    red, green, blue = np.moveaxis(image // (256 // LEVELS), -1, 0)
    return np.asarray(table[red, green, blue])


def _colour_counts(pixels: NDArray[np.uint8]) -> NDArray[np.int64]:
    """(4096,) how many of the (n, 3) pixels have each colour."""
    red, green, blue = (pixels // (256 // LEVELS)).astype(np.int64).T
    return np.asarray(np.bincount((red * LEVELS + green) * LEVELS + blue, minlength=LEVELS**3))


def _to_hex(table: NDArray[np.bool_]) -> str:
    return np.packbits(table).tobytes().hex()


def _from_hex(text: str) -> NDArray[np.bool_]:
    """ValueError for one of another size."""
    bits = np.unpackbits(np.frombuffer(bytes.fromhex(text), np.uint8))
    return np.asarray(bits.astype(np.bool_).reshape(LEVELS, LEVELS, LEVELS))


def with_neighbours(seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(16, 16, 16) colours and those next to them in every direction, of (4096,)."""
    grown = np.pad(seen.reshape(LEVELS, LEVELS, LEVELS), 1)
    for axis in range(3):
        grown = grown | np.roll(grown, 1, axis) | np.roll(grown, -1, axis)
    return grown[1:-1, 1:-1, 1:-1]
