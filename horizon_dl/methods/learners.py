"""Learners fitted for a comparison: the net and the forest, offline and in one pass."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.data.evenly import evenly
from horizon_dl.data.frame import Frame
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View
from horizon_dl.errors import FrameError
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.methods.scores import score_maps
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.forest import HorizonForest, draw_view_pixels
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.online.learner import OnlineLearner
from horizon_dl.uncertainty.measures import P_ABOVE, binary_entropy, measures
from horizon_dl.uncertainty.threshold import MOST_FRAMES, paper_threshold
from horizon_dl.workers import SERIAL, Workers

Map = NDArray[np.float32]

REFIT_EVERY = 20


class Method(Protocol):
    """Anything that gives obstacle scores for a frame, from its view or the frame itself."""

    def score_maps(self, frame: Frame, view: View) -> dict[str, Map]:
        """Scores by name, (h, w) in [0, 1] each; learners also give `p_above`."""
        ...


class StreamLearner(Method, Protocol):
    """A method that learns frame by frame; it may be asked for scores only once it is `ready`."""

    learn_s: float
    predict_every: int
    """Frames that are not scored are predicted, for the threshold's sake, at every so many."""

    def quick_maps(self, view: View) -> dict[str, Map]:
        """`p_above` and `entropy` alone."""
        ...

    @property
    def ready(self) -> bool:
        """Whether it has learned anything yet."""
        ...

    def learn(self, view: View) -> None:
        """Learn from a frame that was predicted before."""
        ...


@dataclass(frozen=True)
class NetMethod:
    """A trained net with dropout at test time; for `agreement` see `fused_score`."""

    net: HorizonFCN
    paths: GeodesicParams = GEODESIC
    agreement: float | None = None

    def score_maps(self, _: Frame, view: View) -> dict[str, Map]:
        """All scores, the single pass without dropout among them."""
        encoded = EncodedImage(self.net, view.image)
        found = encoded.measures(view.elevation > 0)
        return score_maps(view, found, encoded.single_pass()[0], self.paths, self.agreement)


@dataclass(frozen=True)
class ForestMethod:
    """A fitted forest, whose trees are the samples; for `agreement` see `fused_score`."""

    forest: HorizonForest
    paths: GeodesicParams = GEODESIC
    agreement: float | None = None

    def score_maps(self, _: Frame, view: View) -> dict[str, Map]:
        """All scores but the single pass."""
        found = measures(self.forest.p_above_samples(view), view.elevation > 0)
        return score_maps(view, found, paths=self.paths, agreement=self.agreement)

    def quick_maps(self, view: View) -> dict[str, Map]:
        """`p_above` and `entropy` alone, without a path search."""
        p_above = self.forest.p_above_samples(view).mean(axis=0)
        return {P_ABOVE: p_above, "entropy": binary_entropy(p_above)}


def fit_forest(
    store: FrameStore, indices: Sequence[int], seed: int, workers: Workers = SERIAL
) -> ForestMethod:
    """The forest on pixels drawn evenly from the frames of a recording; features and fit are the workers'."""
    config = store.config
    per_frame = -(-config.forest.training_pixels // len(indices))
    shared = (store.recording, config, per_frame)
    items = [(index, (seed, number)) for number, index in enumerate(indices)]
    drawn = list(store.usable(zip(indices, workers.map(_draw_entry, shared, items), strict=True)))
    return ForestMethod(next(workers.map(_fit_drawn, (drawn, config), [seed])), config.geodesic)


def forest_threshold(
    forest: ForestMethod, store: FrameStore, indices: Sequence[int], workers: Workers = SERIAL
) -> float:
    """The paper's threshold, bits: a percentile of the entropies of at most 50 training frames."""
    chosen = evenly(indices, MOST_FRAMES)
    shared = (store.recording, store.config, forest)
    frames = store.usable(zip(chosen, workers.map(_entropy_entry, shared, chosen), strict=True))
    return paper_threshold(frames, store.config.threshold.percentile)


def _entropy_entry(
    shared: tuple[Recording, Config, ForestMethod], index: int
) -> tuple[Map, NDArray[np.bool_]] | FrameError:
    recording, config, forest = shared
    read = FrameStore(recording, config).read(index)
    if isinstance(read, FrameError):
        return read
    view = read[1]
    return forest.quick_maps(view)["entropy"], labelled_pixels(view.elevation, config.labels.band_rad)


Drawn = tuple[NDArray[np.float32], NDArray[np.uint8]]


def _draw_entry(
    shared: tuple[Recording, Config, int], item: tuple[int, tuple[int, int]]
) -> Drawn | FrameError:
    (recording, config, count), (index, seed) = shared, item
    read = FrameStore(recording, config).read(index)
    if isinstance(read, FrameError):
        return read
    return draw_view_pixels(read[1], seed, config.labels.band_rad, count)


def _fit_drawn(shared: tuple[Sequence[Drawn], Config], seed: int) -> HorizonForest:
    return _fit(*shared, seed)


class NetStream:
    """The net, learning online."""

    predict_every = 1

    def __init__(self, config: Config, seed: int) -> None:
        self._learner = OnlineLearner(config, seed)
        self.ready = False
        self.learn_s = 0.0

    @property
    def net(self) -> HorizonFCN:
        """The net as it predicts now."""
        return self._learner.net

    def score_maps(self, _: Frame, view: View) -> dict[str, Map]:
        """All scores, the single pass without dropout among them."""
        found, single_pass = self._learner.predict(view), self._learner.single_pass(view)[0]
        return score_maps(view, found, single_pass, self._learner.config.geodesic)

    def quick_maps(self, view: View) -> dict[str, Map]:
        """`p_above` and `entropy` alone."""
        found = self._learner.predict(view)
        return {P_ABOVE: found.p_above, "entropy": found.entropy}

    def learn(self, view: View) -> None:
        """A few steps on this frame and on remembered ones."""
        start = time.perf_counter()
        self._learner.learn(view)
        self.learn_s += time.perf_counter() - start
        self.ready = True


class ForestStream:
    """The forest, fitted anew to all frames so far after every 20th."""

    predict_every = 5

    def __init__(self, config: Config, seed: int) -> None:
        self._config = config
        self._seed = seed
        self._drawn: list[Drawn] = []
        self._frames = 0
        self._forest: ForestMethod | None = None
        self.learn_s = 0.0

    @property
    def ready(self) -> bool:
        """Whether it has been fitted once."""
        return self._forest is not None

    def score_maps(self, frame: Frame, view: View) -> dict[str, Map]:
        """All scores but the single pass."""
        assert self._forest is not None
        return self._forest.score_maps(frame, view)

    def quick_maps(self, view: View) -> dict[str, Map]:
        """`p_above` and `entropy` alone."""
        assert self._forest is not None
        return self._forest.quick_maps(view)

    def learn(self, view: View) -> None:
        """Keep pixels of this frame; fit when it is time."""
        start = time.perf_counter()
        limit = self._config.forest.training_pixels
        share = limit // REFIT_EVERY
        band_rad = self._config.labels.band_rad
        self._drawn.append(draw_view_pixels(view, (self._seed, self._frames), band_rad, share))
        self._frames += 1
        if self._frames % REFIT_EVERY == 0:
            self._drawn = [_thinned(pixels, limit // self._frames) for pixels in self._drawn]
            fitted = _fit(self._drawn, self._config, self._seed)
            self._forest = ForestMethod(fitted, self._config.geodesic)
        self.learn_s += time.perf_counter() - start


def _thinned(pixels: Drawn, count: int) -> Drawn:
    """At most `count` pixels, evenly over the frame."""
    features, labels = pixels
    chosen = np.linspace(0, len(labels) - 1, min(count, len(labels))).astype(int)
    return features[chosen], labels[chosen]


def _fit(drawn: Sequence[Drawn], config: Config, seed: int) -> HorizonForest:
    features = np.concatenate([feature for feature, _ in drawn])
    labels = np.concatenate([label for _, label in drawn])
    return HorizonForest.fit_pixels(
        features,
        labels,
        seed=seed,
        trees=config.forest.trees,
        min_samples_leaf=config.forest.min_samples_leaf,
    )
