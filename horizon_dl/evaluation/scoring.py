"""Scoring methods on frames: what they say of a frame, counted against its truth."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View
from horizon_dl.errors import FrameError
from horizon_dl.evidence.place import Place, usual_levels
from horizon_dl.methods.learners import Method
from horizon_dl.methods.names import NET
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.obstacle_height import by_height
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.metrics.scored_pixels import scored_pixels
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.uncertainty.measures import P_ABOVE
from horizon_dl.workers import Workers

Map = NDArray[np.float32]


@dataclass(frozen=True)
class Reading:
    """What methods say of one frame.

    Attributes:
        frame: with its truth, if there is one.
        view: the frame as the methods saw it.
        maps: score maps by method and score.
        seconds: time that each method took.
    """

    frame: Frame
    view: View
    maps: Mapping[str, Mapping[str, Map]]
    seconds: Mapping[str, float]


@dataclass(frozen=True)
class ScoredFrame:
    """One test frame as the methods saw it.

    Attributes:
        frame: with its truth, if there is one.
        view: at the working size.
        maps: score maps by method.
        thresholds: the paper's, of the methods that have one.
        places: limits for the evidence of the methods that have some, as they are flown with.
    """

    frame: Frame
    view: View
    maps: Mapping[str, Mapping[str, Map]]
    thresholds: Mapping[str, float]
    places: Mapping[str, Place] = field(default_factory=dict)


OnFrame = Callable[[ScoredFrame], None]


def read_frame(methods: Mapping[str, Method], frame: Frame, view: View) -> Reading:
    """Ask every method."""
    maps, seconds = {}, {}
    for name, method in methods.items():
        start = time.perf_counter()
        maps[name] = method.score_maps(frame, view)
        seconds[name] = time.perf_counter() - start
    return Reading(frame, view, maps, seconds)


def read_frames(
    methods: Mapping[str, Method], store: FrameStore, indices: Sequence[int], workers: Workers
) -> Iterator[Reading]:
    """Ask every method about frames of a recording, by whatever workers there are; in order."""
    shared = (methods, store.recording, store.config)
    yield from store.usable(zip(indices, workers.map(_read_index, shared, indices), strict=True))


def _read_index(shared: tuple[Mapping[str, Method], Recording, Config], index: int) -> Reading | FrameError:
    methods, recording, config = shared
    found = FrameStore(recording, config).read(index)
    return found if isinstance(found, FrameError) else read_frame(methods, *found)


def accumulate(
    readings: Iterable[Reading],
    thresholds: Mapping[str, float],
    band_rad: float,
    on_frame: OnFrame | None = None,
    places: Mapping[str, Place | None] | None = None,
) -> dict[str, MethodAccumulator]:
    """Count readings; thresholds belong to the entropy, places are for `on_frame`."""
    accumulators: dict[str, MethodAccumulator] = {}
    known = {name: place for name, place in (places or {}).items() if place is not None}
    for reading in readings:
        scored = ScoredFrame(reading.frame, reading.view, reading.maps, dict(thresholds), known)
        for name, seconds in reading.seconds.items():
            accumulators.setdefault(name, MethodAccumulator()).add_time(seconds)
        count_frame(accumulators, scored, band_rad)
        if on_frame:
            on_frame(scored)
    return accumulators


def count_frame(accumulators: Mapping[str, MethodAccumulator], scored: ScoredFrame, band_rad: float) -> None:
    """Count what the methods say of one frame in their accumulators."""
    pixels = scored_pixels(scored.frame)
    others = {
        "above": scored_pixels(scored.frame, above=True),
        **by_height(scored.frame, pixels),
    }
    for name, maps in scored.maps.items():
        threshold = scored.thresholds.get(name)
        accumulators[name].update(scored.view, maps, pixels, others, band_rad=band_rad, threshold=threshold)


def count_distances(ranging: RangingBlock, scored: ScoredFrame, learner: str = NET) -> None:
    """Count the distances of a frame by what a learner says."""
    usual = usual_levels(scored.places.get(learner), scored.thresholds[learner])
    ranging.update(scored.frame, scored.maps[learner][P_ABOVE], usual)


def watching(ranging: RangingBlock, on_frame: OnFrame | None, learner: str = NET) -> OnFrame:
    """`on_frame` that also ranges by what a learner says."""

    def watch(scored: ScoredFrame) -> None:
        count_distances(ranging, scored, learner)
        if on_frame:
            on_frame(scored)

    return watch
