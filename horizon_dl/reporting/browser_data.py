"""Frames and thresholds as the page's script takes them: small pictures, and scores as whole numbers."""

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from horizon_dl.geometry.resize import nearest
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.reporting.sections import data_address
from horizon_dl.reporting.stills import Still
from horizon_dl.visualization.cells import resize_map
from horizon_dl.visualization.overlays import contour_coverage, draw_truth

MOST_BYTES = 4_200_000
LEVELS = 96
WIDTH = 360


@dataclass(frozen=True)
class Slider:
    """What the threshold slider of one learner says.

    Attributes:
        name: of the learner.
        score: name of the score.
        threshold: the learner's own.
        roc: rates over all scored frames at thresholds, or None without truth.
    """

    name: str
    score: str
    threshold: float
    roc: RocAccumulator | None = None


def browser_data(stills: Sequence[Still], sliders: Mapping[str, Slider]) -> dict[str, Any]:
    """What the page's script shows; as many frames as a page that is sent by mail may hold."""
    methods, coders = [], {}
    for key, slider in sliders.items():
        coder = _Coder.of([one.said[key].score for one in stills if key in one.said], slider.threshold)
        coders[key] = coder
        methods.append({"key": key, "name": slider.name, "score": slider.score, **coder.data(slider.roc)})
    frames = [_encoded(one, coders) for one in stills]
    sizes = [sum(map(len, _addresses(frame))) for frame in frames]
    while sum(sizes) > MOST_BYTES and len(frames) > 4:
        frames, sizes = frames[::2], sizes[::2]
    return {"methods": methods, "frames": frames}


@dataclass(frozen=True)
class _Coder:
    """Turns scores into small whole numbers that keep their order, so that any threshold can be tried."""

    levels: NDArray[np.float64]
    own: int

    @classmethod
    def of(cls, maps: Sequence[NDArray[np.float16]], threshold: float) -> "_Coder":
        values = np.concatenate([one.ravel()[::7] for one in maps]) if maps else np.array([0.0, 1.0])
        shares = np.linspace(0.0, 1.0, LEVELS)
        quantiles = np.quantile(values.astype(np.float64), shares)
        levels = np.unique(np.append(quantiles, [threshold, 0.02, 0.98]).round(5))
        return cls(levels, int(np.argmin(np.abs(levels - threshold))))

    def code(self, score: NDArray[np.float16]) -> NDArray[np.uint8]:
        """How many levels each pixel exceeds."""
        exact = score.astype(np.float32)
        return np.searchsorted(self.levels.astype(np.float32), exact, side="left").astype(np.uint8)

    def data(self, roc: RocAccumulator | None) -> dict[str, Any]:
        levels = self.levels.tolist()
        middles = [(a + b) / 2 for a, b in zip([levels[0], *levels], [*levels, levels[-1]], strict=True)]
        found: dict[str, Any] = {
            "levels": levels,
            "values": [round(value, 4) for value in middles],
            "own": self.own,
        }
        if roc is not None and (rates := roc.rates_at_all(self.levels)) is not None:
            found["tpr"], found["fpr"] = ([round(float(x), 4) for x in one] for one in rates)
        return found


def _encoded(one: Still, coders: Mapping[str, _Coder]) -> dict[str, Any]:
    width = min(WIDTH, one.image.shape[1])
    height = max(1, round(one.image.shape[0] * width / one.image.shape[1]))
    size = (width, height)
    elevation = resize_map(one.elevation, width, height)
    line = (contour_coverage(elevation, 0.0, 2.0) >= 0.5).astype(np.uint8) * 255
    maps = {}
    for key, said in one.said.items():
        code = PilImage.fromarray(nearest(coders[key].code(said.score), height, width))
        sides = (np.clip(said.p_above, 0, 1).astype(np.float32) * 255).round().astype(np.uint8)
        maps[key] = {
            "score": _address(code, lossless=True),
            "side": _address(PilImage.fromarray(sides).resize(size)),
            "ranges": None if said.ranges is None else _address(PilImage.fromarray(said.ranges)),
            "auc": said.auc,
        }
    photo = PilImage.fromarray(one.image).resize(size, PilImage.Resampling.BOX)
    return {
        "name": one.name,
        "time": one.time_s if math.isfinite(one.time_s) else None,
        "words": one.words,
        "photo": _address(photo),
        "horizon": _address(PilImage.fromarray(line), lossless=True) if line.any() else None,
        "truth": None if one.truth is None else _truth_address(one, size),
        "maps": maps,
    }


def _truth_address(one: Still, size: tuple[int, int]) -> str:
    assert one.truth is not None  # as its caller has seen
    return _address(PilImage.fromarray(draw_truth(one.image, one.truth)).resize(size))


def _address(picture: PilImage.Image, lossless: bool = False) -> str:
    buffer = io.BytesIO()
    kind = {"lossless": True, "quality": 100, "method": 4} if lossless else {"quality": 78, "method": 4}
    picture.convert("RGB").save(buffer, "WEBP", **kind)
    return data_address(buffer.getvalue())


def _addresses(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [address for one in value.values() for address in _addresses(one)]
    return [value] if isinstance(value, str) else []
