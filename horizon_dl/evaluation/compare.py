"""The comparison: net, forest and training-free baselines on the same frames of one recording."""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from horizon_dl.config import Config
from horizon_dl.errors import InputError
from horizon_dl.evaluation.learners import (
    ForestMethod,
    ForestStream,
    Method,
    NetMethod,
    NetStream,
    StreamLearner,
    fit_forest,
)
from horizon_dl.evaluation.metrics import SCHEMA, method_metrics
from horizon_dl.evaluation.protocols import Protocol, Split, split_frames
from horizon_dl.evaluation.ranging_block import RangingBlock
from horizon_dl.evaluation.tally import Tally, scored_pixels
from horizon_dl.evaluation.training_free import training_free_methods
from horizon_dl.frames.frame import Frame, Recording
from horizon_dl.geometry.view import View
from horizon_dl.learning.store import FrameStore
from horizon_dl.learning.train import THRESHOLD_FRAMES, entropy_threshold, evenly, train_net
from horizon_dl.obstacles.percentile import RunningPercentile, stream_percentile
from horizon_dl.uncertainty.scores import P_ABOVE

Map = NDArray[np.float32]

LEARNERS = ("cnn", "rf")
THRESHOLD_EVERY = 5
"""In one pass, every fifth frame is predicted for the threshold's sake even where it has no truth."""


@dataclass(frozen=True)
class ScoredFrame:
    """One test frame as the methods saw it: score maps and thresholds (None without one) by method."""

    frame: Frame
    view: View
    maps: Mapping[str, Mapping[str, Map]]
    thresholds: Mapping[str, float]


OnFrame = Callable[[ScoredFrame], None]


@dataclass
class Comparison:
    """Figures of all methods.

    Attributes:
        metrics: the content of `metrics.json`.
        tallies: by method, one a seed; the curves are drawn from them.
        skipped: reason by name of the frames that could not be used.
    """

    metrics: dict[str, Any]
    tallies: dict[str, list[Tally]]
    skipped: dict[str, str] = field(default_factory=dict)


def compare(
    recording: Recording,
    config: Config,
    protocol: Protocol,
    seeds: Sequence[int],
    *,
    on_frame: OnFrame | None = None,
    progress: bool = False,
) -> Comparison:
    """Train and score every method under every seed.

    Args:
        recording: with truth for figures; without any, only accuracies and times are measured.
        config: one for all.
        protocol: see `split_frames`.
        seeds: one run of each learner a seed; baselines have no seed.
        on_frame: called with every test frame of the first seed.
        progress: show progress bars.

    Raises:
        InputError: nothing to train on or to test, or too many frames cannot be used.
    """
    split = split_recording(recording, protocol)
    store = FrameStore(recording, config)
    run_seed = _prequential if protocol == "prequential" else _offline
    tallies: dict[str, list[Tally]] = {name: [] for name in LEARNERS}
    ranging = RangingBlock(recording)
    watch = watching(ranging, on_frame)
    for number, seed in enumerate(seeds):
        found = run_seed(store, split, seed, watch if number == 0 else None, progress)
        for name, tally in found.items():
            tallies[name].append(tally)
    tallies |= {name: [tally] for name, tally in _baselines(store, split.test, progress).items()}
    rule = f"percentile-{config.threshold.percentile:g}"
    metrics = {
        "schema": SCHEMA,
        "data": recording.name,
        "protocol": protocol,
        "seeds": list(seeds),
        "frames": {"train": len(split.train), "test": len(split.test), "skipped": len(store.skipped)},
        "methods": {name: method_metrics(found, rule) for name, found in tallies.items()},
        "ranging": ranging.metrics(),
    }
    return Comparison(metrics, tallies, store.skipped)


def split_recording(recording: Recording, protocol: Protocol) -> Split:
    """`split_frames` of a recording; InputError where it leaves nothing to train on or to test."""
    split = split_frames(protocol, [entry.truth_path is not None for entry in recording.entries])
    if not split.train or not split.test:
        problem = (
            f"has {len(recording.entries)} frames, of which the protocol '{protocol}' leaves "
            f"{len(split.train)} to train on and {len(split.test)} to test"
        )
        raise InputError(recording.name, problem, "take another --protocol, or more labelled frames")
    return split


def score_frames(
    methods: Mapping[str, Method],
    thresholds: Mapping[str, float],
    frames: Iterable[tuple[Frame, View]],
    band_rad: float,
    on_frame: OnFrame | None = None,
) -> dict[str, Tally]:
    """Score methods on frames; thresholds belong to the entropy."""
    tallies = {name: Tally() for name in methods}
    for frame, view in frames:
        maps = {name: _timed_scores(method, view, tallies[name]) for name, method in methods.items()}
        scored = ScoredFrame(frame, view, maps, dict(thresholds))
        _count(tallies, scored, band_rad)
        if on_frame:
            on_frame(scored)
    return tallies


def _offline(
    store: FrameStore, split: Split, seed: int, on_frame: OnFrame | None, progress: bool
) -> dict[str, Tally]:
    config = store.config
    start = time.perf_counter()
    net = train_net(store, split.train, seed=seed, progress=progress)
    net_s = time.perf_counter() - start
    forest = fit_forest(store, split.train, seed)
    forest_s = time.perf_counter() - start - net_s
    methods: dict[str, Method] = {"cnn": NetMethod(net), "rf": forest}
    thresholds = {
        "cnn": entropy_threshold(net, store, split.train),
        "rf": _forest_threshold(forest, store, split.train),
    }
    frames = _bar(store.frames(split.test), f"test, seed {seed}", len(split.test), progress)
    tallies = score_frames(methods, thresholds, frames, config.labels.band_rad, on_frame)
    tallies["cnn"].train_s, tallies["rf"].train_s = net_s, forest_s
    return tallies


def _forest_threshold(forest: ForestMethod, store: FrameStore, indices: Sequence[int]) -> float:
    views = store.views(evenly(indices, THRESHOLD_FRAMES))
    entropies = (forest.score_maps(view)["entropy"][~np.isnan(view.elevation)] for view in views)
    return stream_percentile(entropies, store.config.threshold.percentile)


def _prequential(
    store: FrameStore, split: Split, seed: int, on_frame: OnFrame | None, progress: bool
) -> dict[str, Tally]:
    config = store.config
    streams: dict[str, StreamLearner] = {"cnn": NetStream(config, seed), "rf": ForestStream(config, seed)}
    tallies = {name: Tally() for name in streams}
    entropies = {name: RunningPercentile(config.threshold.percentile) for name in streams}
    tested = {store.recording.entries[index].name for index in split.test}
    frames = _bar(store.frames(split.train), f"online, seed {seed}", len(split.train), progress)
    for number, (frame, view) in enumerate(frames):
        wanted = frame.name in tested or number % THRESHOLD_EVERY == 0
        ready = {name: stream for name, stream in streams.items() if stream.ready and wanted}
        maps = {name: _timed_scores(stream, view, tallies[name]) for name, stream in ready.items()}
        if frame.name in tested and len(ready) == len(streams):
            scored = ScoredFrame(frame, view, maps, {name: entropies[name].value() for name in maps})
            _count(tallies, scored, config.labels.band_rad)
            if on_frame:
                on_frame(scored)
        for name, found in maps.items():
            entropies[name].add(found["entropy"])
        for stream in streams.values():
            stream.learn(view)
    for name, stream in streams.items():
        tallies[name].train_s = stream.learn_s
    return tallies


def _baselines(store: FrameStore, test: Sequence[int], progress: bool) -> dict[str, Tally]:
    frames = _bar(store.frames(test), "baselines", len(test), progress)
    return score_frames(training_free_methods(), {}, frames, store.config.labels.band_rad)


def watching(ranging: RangingBlock, on_frame: OnFrame | None) -> OnFrame:
    """`on_frame` that also ranges by what the net says."""

    def watch(scored: ScoredFrame) -> None:
        ranging.add(scored.frame, scored.maps["cnn"][P_ABOVE], scored.thresholds["cnn"])
        if on_frame:
            on_frame(scored)

    return watch


def _bar(
    frames: Iterable[tuple[Frame, View]], what: str, total: int, progress: bool
) -> Iterable[tuple[Frame, View]]:
    bar: Iterable[tuple[Frame, View]] = tqdm(frames, what, total=total, unit="frame", disable=not progress)
    return bar


def _timed_scores(method: Method, view: View, tally: Tally) -> dict[str, Map]:
    start = time.perf_counter()
    maps = method.score_maps(view)
    tally.predict_s += time.perf_counter() - start
    tally.frames += 1
    return maps


def _count(tallies: Mapping[str, Tally], scored: ScoredFrame, band_rad: float) -> None:
    pixels = scored_pixels(scored.frame)
    for name, maps in scored.maps.items():
        tally = tallies[name]
        if P_ABOVE in maps:
            tally.add_sides(scored.view, maps[P_ABOVE], band_rad)
        tally.add_scores(maps, pixels)
        if name in scored.thresholds:
            tally.threshold = scored.thresholds[name]
            tally.add_obstacle_map(maps["entropy"], tally.threshold, pixels)
