"""The comparison: net, forest and training-free baselines on the same frames of one recording."""

import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from horizon_dl.config import Config
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.evaluation.deal import Part, dealt
from horizon_dl.evaluation.progressive import ProgressiveValidation
from horizon_dl.evaluation.protocols import Protocol, Split, split_frames
from horizon_dl.evaluation.scoring import (
    OnFrame,
    accumulate,
    read_frames,
    watching,
)
from horizon_dl.methods.learners import (
    ForestStream,
    Method,
    NetMethod,
    NetStream,
    StreamLearner,
    fit_forest,
    forest_threshold,
)
from horizon_dl.methods.names import FOREST, LEARNERS, NET
from horizon_dl.methods.training_free import training_free_methods
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metrics import metrics_file
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.progress import show_progress
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.training.context import agreement_of
from horizon_dl.training.evidence import place_of
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.thresholds import paper_threshold_of
from horizon_dl.training.train import evidence_of, train_net
from horizon_dl.uncertainty.measures import P_ABOVE
from horizon_dl.uncertainty.threshold import PaperThreshold
from horizon_dl.workers import SERIAL, Workers, processes_beside

T = TypeVar("T")
TOLD = ("self_assessment", "path_agreement", "deep_share")
"""What `metrics.json` says of the first seed's net; a net that learns in one pass knows no agreement."""

Learned = tuple[dict[str, MethodAccumulator], HorizonFCN | None, dict[str, Any]]
"""Figures, the net if it was asked for, and what it says of its training frames (empty if not asked yet)."""


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


@dataclass(frozen=True)
class _Task:
    """What is to be learned and scored in one go.

    Attributes:
        store: where the frames come from.
        split: which are learned from, and which scored.
        seed: of the learners.
        learners: their names.
        on_frame: called with every test frame.
        progress: show progress bars.
        workers: see `compare`; `prequential` asks none.
    """

    store: FrameStore
    split: Split
    seed: int
    learners: Sequence[str]
    on_frame: OnFrame | None = None
    progress: bool = False
    workers: Workers = SERIAL


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
        jobs: processes on this machine, among which what comes after the first seed is dealt out.
        vehicle: count distances also of what is in its way.

    Raises:
        InputError: nothing to train on or to test, or too many frames cannot be used.
    """
    split = split_recording(recording, protocol)
    store = FrameStore(recording, config)
    ranging = RangingBlock(recording.headers, config.ranging_params, vehicle)
    task = _Task(store, split, seeds[0], LEARNERS, watching(ranging, on_frame), progress, workers)
    found: dict[Part, MethodAccumulator] = {}
    with processes_beside(jobs) as beside:
        own, *others = dealt(seeds, 1 + len(beside))
        started = {
            part: executor.submit(_run_part, recording, config, protocol, part)
            for executor, share in zip(beside, others, strict=True)
            for part in share
        }
        first, net, evidence = _run(protocol, task)
        _check(started.values())
        baselines = _baselines(store, split.test, progress, workers)
        for learner, seed in own:
            _check(started.values())
            further = replace(task, seed=seed, learners=(learner,), on_frame=None)
            found |= _by_part(_run(protocol, further)[0], seed)
        for (_, seed), future in started.items():
            found |= _by_part(future.result(), seed)
    found |= _by_part(first, seeds[0])
    accumulators = {name: [found[name, seed] for seed in seeds] for name in LEARNERS}
    accumulators |= {name: [accumulator] for name, accumulator in baselines.items()}
    rule = PaperThreshold(config.threshold.percentile).rule
    assert net is not None  # the first seed is of all learners
    evidence = evidence or evidence_of(net, store, split.train)
    frames = {"train": len(split.train), "test": len(split.test), "skipped": len(store.skipped)}
    metrics = metrics_file(recording.name, protocol, seeds, frames, accumulators, rule, ranging)
    told = ("self_assessment",) if protocol == "prequential" else TOLD
    metrics["methods"][NET] |= {key: evidence[key] for key in told}
    return Comparison(metrics, accumulators, store.skipped, net)


def _check(started: Iterable[Future[Any]]) -> None:
    """Raise what ended one of the processes beside, before more is done here."""
    for future in started:
        if future.done():
            future.result()


def _by_part(found: dict[str, MethodAccumulator], seed: int) -> dict[Part, MethodAccumulator]:
    return {(name, seed): accumulator for name, accumulator in found.items()}


def _run_part(
    recording: Recording, config: Config, protocol: Protocol, part: Part
) -> dict[str, MethodAccumulator]:
    """A learner under a seed, in a process of its own."""
    split = split_recording(recording, protocol)
    return _run(protocol, _Task(FrameStore(recording, config), split, part[1], part[:1]))[0]


def _run(protocol: Protocol, task: _Task) -> Learned:
    return _prequential(task) if protocol == "prequential" else _offline(task)


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


def _offline(task: _Task) -> Learned:
    store, split, seed, learners = task.store, task.split, task.seed, task.learners
    methods: dict[str, Method] = {}
    thresholds: dict[str, float] = {}
    train_s: dict[str, float] = {}
    net: HorizonFCN | None = None
    evidence: dict[str, Any] = {}
    start = time.perf_counter()
    if NET in learners:
        net = train_net(store, split.train, seed=seed, progress=task.progress)
        train_s[NET] = time.perf_counter() - start
        # What is drawn and ranged is what would be flown: by the net's evidence.
        evidence = evidence_of(net, store, split.train)
        methods[NET] = NetMethod(net, store.config.geodesic, evidence["path_agreement"])
        thresholds[NET] = paper_threshold_of(net, store, split.train)
    start = time.perf_counter()
    if FOREST in learners:
        forest = fit_forest(store, split.train, seed, task.workers)
        train_s[FOREST] = time.perf_counter() - start
        thresholds[FOREST] = forest_threshold(forest, store, split.train, task.workers)
        agreement = agreement_of(lambda view: forest.quick_maps(view)[P_ABOVE], store, split.train)
        methods[FOREST] = replace(forest, agreement=agreement)
    readings = read_frames(methods, store, split.test, task.workers)
    bar = _bar(readings, f"test, seed {seed}", len(split.test), task.progress)
    places = {NET: place_of(evidence, NET)}
    accumulators = accumulate(bar, thresholds, store.config.labels.band_rad, task.on_frame, places)
    for name, seconds in train_s.items():
        accumulators[name].train_s = seconds
    if net is not None:
        accumulators[NET].simulated_threshold = evidence["simulated_threshold"]
    return accumulators, net, evidence


def _prequential(task: _Task) -> Learned:
    store, split, seed, learners = task.store, task.split, task.seed, task.learners
    kinds: dict[str, Callable[[Config, int], StreamLearner]] = {NET: NetStream, FOREST: ForestStream}
    streams = {name: kinds[name](store.config, seed) for name in learners}
    validation = ProgressiveValidation(streams, store.config)
    for index, item in enumerate(_bar(split.train, f"online, seed {seed}", len(split.train), task.progress)):
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
            if found is not None and task.on_frame:
                task.on_frame(found)
            for stream in streams.values():
                stream.learn(view)
    for name, stream in streams.items():
        validation.accumulators[name].train_s = stream.learn_s
    learned = streams.get(NET)
    return validation.accumulators, learned.net if isinstance(learned, NetStream) else None, {}


def _baselines(
    store: FrameStore, test: Sequence[int], progress: bool, workers: Workers
) -> dict[str, MethodAccumulator]:
    readings = read_frames(training_free_methods(store.config.geodesic), store, test, workers)
    bar = _bar(readings, "baselines", len(test), progress)
    return accumulate(bar, {}, store.config.labels.band_rad)


def _bar(items: Iterable[T], what: str, total: int, progress: bool) -> Iterable[T]:
    bar: Iterable[T] = show_progress(items, what, total=total, unit="frame", disable=not progress)
    return bar
