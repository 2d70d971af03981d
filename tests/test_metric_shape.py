"""Every metric has one shape: halves merged give the whole, and a state goes on where it was taken."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scene import CAMERA, scene

from horizon_dl.data.frame import RangeImage
from horizon_dl.evidence.self_assessment import SelfAssessment
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metric import Metric
from horizon_dl.metrics.metric_snapshot import metric_snapshot, restore_metric
from horizon_dl.metrics.ranging import RangingAccumulator
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.metrics.running import RunningSides
from horizon_dl.metrics.scored_pixels import Confusion, ScoredPixels, scored_pixels
from horizon_dl.ranging.usual_levels import UsualLevels
from horizon_dl.training.checkpoint import Snapshot, read_checkpoint, write_checkpoint
from horizon_dl.uncertainty.threshold import PaperThreshold

SIZE = 24


def frames(count: int = 6) -> list[dict[str, Any]]:
    found = []
    for index in range(count):
        random = np.random.default_rng(index)
        angle = np.linspace(0.5, -0.5, SIZE)[:, None] * np.ones((SIZE, SIZE))
        positive = random.random((SIZE, SIZE)) < 0.3
        score = np.clip(0.3 * random.random((SIZE, SIZE)) + 0.5 * positive, 0, 1).astype(np.float32)
        found.append({"score": score, "positive": positive, "angle": angle.astype(np.float32)})
    return found


def pixels_of(one: dict[str, Any]) -> ScoredPixels:
    mask = one["angle"] < 0
    return ScoredPixels(mask, one["positive"][mask], -one["angle"][mask])


def update_method(metric: MethodAccumulator, one: dict[str, Any], index: int) -> None:
    frame, prediction = scene(index)
    maps = {"p_above": prediction.measures.p_above, "entropy": prediction.measures.entropy}
    maps |= {"surprisal": prediction.flown_score} if index % 2 else {}
    others = {"above": scored_pixels(frame, above=True)}
    metric.add_time(0.25)
    threshold = 0.5 if index else None
    pixels = scored_pixels(frame)
    metric.update(prediction.view, maps, pixels, others, band_rad=0.02, threshold=threshold)


def update_ranging(metric: Any, one: dict[str, Any], index: int) -> None:
    frame, prediction = scene(index)
    metres = np.full((CAMERA.height, CAMERA.width), 4.0, np.float32)
    p_above = prediction.measures.p_above
    if isinstance(metric, RangingBlock):
        ranged = frame.__class__(**{**vars(frame), "ranges": RangeImage(metres, "ray")})
        metric.update(ranged, p_above, UsualLevels(0.5))
    else:
        metric.update(frame, p_above, metres)


def update_roc(metric: RocAccumulator, one: dict[str, Any], _: int) -> None:
    metric.update(one["score"].ravel(), one["positive"].ravel(), np.abs(one["angle"]).ravel())


METRICS: dict[str, tuple[Callable[[], Any], Callable[..., None]]] = {
    "roc": (RocAccumulator, update_roc),
    "reliability": (Reliability, lambda m, one, _: m.update(one["score"].ravel(), one["positive"].ravel())),
    "confusion": (Confusion, lambda m, one, _: m.update(one["score"] > 0.4, pixels_of(one))),
    "method": (MethodAccumulator, update_method),
    "ranging": (RangingAccumulator, update_ranging),
    "block": (RangingBlock, update_ranging),
    "sides": (RunningSides, lambda m, one, _: m.update(one["score"], one["angle"], 0.02)),
    "threshold": (lambda: PaperThreshold(25.0), lambda m, one, _: m.update(one["score"], one["angle"] < 0)),
    "assessment": (
        SelfAssessment,
        lambda m, one, _: m.update(one["score"], one["score"] ** 2, one["angle"]),
    ),
}


def counted(name: str, first: int, last: int) -> Any:
    make, update = METRICS[name]
    metric = make()
    for index, one in list(enumerate(frames()))[first:last]:
        update(metric, one, index)
    return metric


def same(one: Any, other: Any) -> None:
    assert repr(one) == repr(other)


@pytest.mark.parametrize("name", METRICS)
def test_halves_merged_are_the_whole(name: str) -> None:
    halves, whole = counted(name, 0, 3), counted(name, 0, 6)
    halves.merge(counted(name, 3, 6))
    same(halves.compute(), whole.compute())
    assert halves.compute() != METRICS[name][0]().compute()


@pytest.mark.parametrize("name", METRICS)
def test_a_state_goes_on_as_if_nothing_had_happened(name: str) -> None:
    make, update = METRICS[name]
    before, after = counted(name, 0, 3), make()
    after.load(before.state())
    same(after.compute(), before.compute())
    for index, one in list(enumerate(frames()))[3:]:
        update(after, one, index)
    same(after.compute(), counted(name, 0, 6).compute())
    same(before.compute(), counted(name, 0, 3).compute())  # nothing is shared with what was saved


@pytest.mark.parametrize("name", METRICS)
def test_an_empty_one_has_a_state_and_adds_nothing(name: str) -> None:
    make, _ = METRICS[name]
    empty, whole = make(), counted(name, 0, 6)
    empty.load(make().state())
    whole.merge(empty)
    same(whole.compute(), counted(name, 0, 6).compute())


@pytest.mark.parametrize("name", METRICS)
def test_a_state_survives_a_checkpoint(name: str, tmp_path: Any) -> None:
    metric: Metric = counted(name, 0, 6)
    write_checkpoint(tmp_path / "checkpoint", Snapshot.join({"one": metric_snapshot(metric)}))
    restored: Metric = METRICS[name][0]()
    restore_metric(restored, read_checkpoint(tmp_path / "checkpoint").part("one"))
    same(restored.compute(), metric.compute())


def test_the_state_of_another_metric_does_not_fit() -> None:
    with pytest.raises(KeyError):
        RunningSides().load(counted("roc", 0, 2).state())
    with pytest.raises(ValueError, match="does not fit"):
        Reliability(10).load(counted("reliability", 0, 2).state())
