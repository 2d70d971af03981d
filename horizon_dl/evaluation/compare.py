"""The comparison: net, forest and training-free baselines on the same frames of one recording."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import cycle
from typing import Any, TypeVar

from horizon_dl.config import Config
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.evaluation.progressive import ProgressiveValidation
from horizon_dl.evaluation.protocols import Protocol, Split, split_frames
from horizon_dl.evaluation.scoring import (
    OnFrame,
    accumulate,
    read_frames,
    watching,
)
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.methods.learners import (
    ForestMethod,
    ForestStream,
    Method,
    NetMethod,
    NetStream,
    QuickForest,
    StreamLearner,
    fit_forest,
)
from horizon_dl.methods.registry import FOREST, LEARNERS, NET
from horizon_dl.methods.training_free import training_free_methods
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metrics import SCHEMA, method_metrics
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.progress import show_progress
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.training.evidence import place_of
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.train import entropy_threshold, evenly, evidence_of, train_net
from horizon_dl.uncertainty.threshold import MOST_FRAMES, PaperThreshold, paper_threshold
from horizon_dl.workers import SERIAL, Workers, processes_beside

T = TypeVar("T")

Learned = tuple[dict[str, MethodAccumulator], HorizonFCN, dict[str, Any]]
"""Figures, the net, and what it says of its training frames (`evidence_of`; empty if not asked yet)."""


@dataclass
class Comparison:
    """Figures of all methods.

    Attributes:
        metrics: the content of `metrics.json`.
        accumulators: by method, one a seed; the curves are drawn from them.
        skipped: reason by name of the frames that could not be used.
        net: of the first seed, where one was trained.
    """

    metrics: dict[str, Any]
    accumulators: dict[str, list[MethodAccumulator]]
    skipped: dict[str, str] = field(default_factory=dict)
    net: HorizonFCN | None = None


def compare(
    recording: Recording,
    config: Config,
    protocol: Protocol,
    seeds: Sequence[int],
    *,
    on_frame: OnFrame | None = None,
    progress: bool = False,
    workers: Workers = SERIAL,
    jobs: int = 1,
    vehicle: VehicleHeight | None = None,
) -> Comparison:
    """Train and score every method under every seed.

    Args:
        recording: with truth for figures; without any, only accuracies and times are measured.
        config: one for all.
        protocol: see `split_frames`.
        seeds: one run of each learner a seed; baselines have no seed.
        on_frame: called with every test frame of the first seed.
        progress: show progress bars.
        workers: who computes features, fits the forest and scores frames; `prequential`, frame by frame,
            stays in this process.
        jobs: processes on this machine; seeds after the first run in the others.
        vehicle: count distances also of what is in its way.

    Raises:
        InputError: nothing to train on or to test, or too many frames cannot be used.
    """
    split = split_recording(recording, protocol)
    store = FrameStore(recording, config)
    run_seed = _run_seed(protocol)
    accumulators: dict[str, list[MethodAccumulator]] = {name: [] for name in LEARNERS}
    ranging = RangingBlock(recording.headers, config.ranging_params, vehicle)
    watch = watching(ranging, on_frame)
    nets: list[tuple[HorizonFCN, dict[str, Any]]] = []
    with processes_beside(jobs) as beside:
        started = [
            executor.submit(_further_seed, recording, config, protocol, seed)
            for executor, seed in zip(cycle(beside), seeds[1:], strict=False)
        ]
        first = run_seed(store, split, seeds[0], watch, progress, workers)
        baselines = _baselines(store, split.test, progress, workers)
        rest = [one.result() for one in started] or [
            run_seed(store, split, seed, None, progress, workers) for seed in seeds[1:]
        ]
    for found, net, evidence in (first, *rest):
        nets.append((net, evidence))
        for name, accumulator in found.items():
            accumulators[name].append(accumulator)
    accumulators |= {name: [accumulator] for name, accumulator in baselines.items()}
    rule = PaperThreshold(config.threshold.percentile).rule
    methods = {name: method_metrics(found, rule) for name, found in accumulators.items()}
    net, evidence = nets[0]
    evidence = evidence or evidence_of(net, store, split.train)
    methods[NET]["self_assessment"] = evidence["self_assessment"]
    metrics = {
        "schema": SCHEMA,
        "data": recording.name,
        "protocol": protocol,
        "seeds": list(seeds),
        "frames": {"train": len(split.train), "test": len(split.test), "skipped": len(store.skipped)},
        "methods": methods,
        "ranging": ranging.compute(),
    }
    return Comparison(metrics, accumulators, store.skipped, net)


def _run_seed(protocol: Protocol) -> Callable[..., Learned]:
    return _prequential if protocol == "prequential" else _offline


def _further_seed(recording: Recording, config: Config, protocol: Protocol, seed: int) -> Learned:
    """One seed in a process of its own."""
    store, split = FrameStore(recording, config), split_recording(recording, protocol)
    return _run_seed(protocol)(store, split, seed, None, False, SERIAL)


def split_recording(recording: Recording, protocol: Protocol) -> Split:
    """`split_frames` of a recording; InputError where it leaves nothing to train on or to test."""
    split = split_frames(protocol, [entry.labelled for entry in recording.headers])
    if not split.train or not split.test:
        problem = (
            f"has {recording.length} frames, of which the protocol '{protocol}' leaves "
            f"{len(split.train)} to train on and {len(split.test)} to test"
        )
        raise InputError(recording.name, problem, "take another --protocol, or more labelled frames")
    return split


def _offline(
    store: FrameStore, split: Split, seed: int, on_frame: OnFrame | None, progress: bool, workers: Workers
) -> Learned:
    config = store.config
    start = time.perf_counter()
    net = train_net(store, split.train, seed=seed, progress=progress)
    net_s = time.perf_counter() - start
    forest = fit_forest(store, split.train, seed, workers)
    forest_s = time.perf_counter() - start - net_s
    methods: dict[str, Method] = {NET: NetMethod(net, config.geodesic), FOREST: forest}
    thresholds = {
        NET: entropy_threshold(net, store, split.train),
        FOREST: _forest_threshold(forest, store, split.train, workers),
    }
    readings = read_frames(methods, store, split.test, workers)
    bar = _bar(readings, f"test, seed {seed}", len(split.test), progress)
    # What is drawn is what would be flown, so the net's evidence is needed before the first frame.
    evidence = evidence_of(net, store, split.train) if on_frame else {}
    places = {NET: place_of(evidence, NET)}
    accumulators = accumulate(bar, thresholds, config.labels.band_rad, on_frame, places)
    accumulators[NET].train_s, accumulators[FOREST].train_s = net_s, forest_s
    return accumulators, net, evidence


def _forest_threshold(
    forest: ForestMethod, store: FrameStore, indices: Sequence[int], workers: Workers
) -> float:
    band_rad = store.config.labels.band_rad
    readings = read_frames({FOREST: QuickForest(forest)}, store, evenly(indices, MOST_FRAMES), workers)
    frames = (
        (reading.maps[FOREST]["entropy"], labelled_pixels(reading.view.elevation, band_rad))
        for reading in readings
    )
    return paper_threshold(frames, store.config.threshold.percentile)


def _prequential(
    store: FrameStore, split: Split, seed: int, on_frame: OnFrame | None, progress: bool, _: Workers
) -> Learned:
    net = NetStream(store.config, seed)
    streams: dict[str, StreamLearner] = {NET: net, FOREST: ForestStream(store.config, seed)}
    validation = ProgressiveValidation(streams, store.config, store.recording.headers)
    for index, item in enumerate(_bar(split.train, f"online, seed {seed}", len(split.train), progress)):
        read = store.read(item)
        for frame, view in store.usable([(item, read)]):
            scored = validation.scores(index, frame)
            maps = {}
            for name, stream in streams.items():
                if stream.ready and (scored or index % stream.predict_every == 0):
                    start = time.perf_counter()
                    maps[name] = stream.score_maps(frame, view) if scored else stream.quick_maps(view)
                    validation.accumulators[name].add_time(time.perf_counter() - start)
            found = validation.update(index, frame, view, maps)
            if found is not None and on_frame:
                on_frame(found)
            for stream in streams.values():
                stream.learn(view)
    for name, stream in streams.items():
        validation.accumulators[name].train_s = stream.learn_s
    return validation.accumulators, net.net, {}


def _baselines(
    store: FrameStore, test: Sequence[int], progress: bool, workers: Workers
) -> dict[str, MethodAccumulator]:
    readings = read_frames(training_free_methods(store.config.geodesic), store, test, workers)
    bar = _bar(readings, "baselines", len(test), progress)
    return accumulate(bar, {}, store.config.labels.band_rad)


def _bar(items: Iterable[T], what: str, total: int, progress: bool) -> Iterable[T]:
    bar: Iterable[T] = show_progress(items, what, total=total, unit="frame", disable=not progress)
    return bar
