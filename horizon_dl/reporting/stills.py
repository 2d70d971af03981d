"""Frames for the browser of a page: a bounded number, evenly spread, and those that went worst."""

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from horizon_dl.data.frame import Frame, Truth
from horizon_dl.data.view import View
from horizon_dl.metrics.roc import frame_auc
from horizon_dl.reporting.sections import data_address
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.cells import resize_map
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.film_picture import title_of
from horizon_dl.visualization.overlays import contour_coverage, draw_truth, shrink_truth

Floats = NDArray[np.floating]

MOST_FRAMES, MOST_WORST = 12, 10
MOST_BYTES = 4_200_000
LEVELS = 96
WIDTH = 360


@dataclass(frozen=True)
class Said:
    """What one learner says of a frame; maps (h, w).

    Attributes:
        score: the map that its threshold belongs to.
        p_above: probability of above.
        ranges: distances, drawn, or None.
        auc: of the score on this frame alone, below the horizon; None without truth.
    """

    score: NDArray[np.float16]
    p_above: NDArray[np.float16]
    ranges: Image | None
    auc: float | None


@dataclass(frozen=True)
class Still:
    """One frame of the browser, with what each learner says of it."""

    name: str
    time_s: float
    image: Image
    elevation: Floats
    truth: NDArray[np.uint8] | None
    said: Mapping[str, Said]
    words: str = ""


def auc_of(view: View, score: Floats, truth: NDArray[np.uint8] | None) -> float | None:
    """AUC of obstacle against floor below the horizon of one frame, at the working size."""
    if truth is None:
        return None
    small = shrink_truth(truth, score.shape[1], score.shape[0])
    with np.errstate(invalid="ignore"):
        used = np.isin(small, (Truth.FLOOR, Truth.OBSTACLE)) & (view.elevation < 0)
    return frame_auc(np.asarray(score[used], np.float32), small[used] == Truth.OBSTACLE)


def still(frame: Frame, view: View, said: Mapping[str, Said], ranges: Ranged | None) -> Still:
    """A frame for the browser."""
    truth = None
    if frame.truth is not None:
        truth = shrink_truth(frame.truth, view.image.shape[1], view.image.shape[0])
    return Still(frame.name, frame.time_s, view.image, view.elevation, truth, said, title_of(ranges))


@dataclass
class Stills:
    """Gathers frames as they come, however many, in bounded memory.

    Attributes:
        by: learner whose AUC says which frames are the worst.
        even: evenly spread; their distance doubles whenever there are too many.
        worst: with the lowest AUC.
    """

    by: str
    even: list[tuple[int, Still]] = field(default_factory=list)
    worst: list[tuple[float, int, Still]] = field(default_factory=list)
    count: int = 0
    _step: int = 1

    def add(self, one: Still) -> None:
        """Take a frame."""
        index = self.count
        self.count += 1
        if index % self._step == 0:
            self.even.append((index, one))
            if len(self.even) > 2 * MOST_FRAMES:
                self._step *= 2
                self.even = [pair for pair in self.even if pair[0] % self._step == 0]
        said = one.said.get(self.by)
        if said is not None and said.auc is not None:
            self.worst.append((said.auc, index, one))
            self.worst = sorted(self.worst, key=lambda entry: entry[:2])[:MOST_WORST]

    def chosen(self) -> list[Still]:
        """All kept frames in order."""
        kept = dict(self.even) | {index: one for _, index, one in self.worst}
        return [kept[index] for index in sorted(kept)]


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
    roc: "Any | None" = None


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

    def data(self, roc: Any | None) -> dict[str, Any]:
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
        code = PilImage.fromarray(coders[key].code(said.score)).resize(size, PilImage.Resampling.NEAREST)
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
