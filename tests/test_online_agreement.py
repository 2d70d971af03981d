"""Learning in one pass follows how far net and paths agree, as the last round of a training does."""

import json
from typing import Any

import numpy as np
import pytest
from small_run import toy_set

from horizon_dl.config import load_config
from horizon_dl.data.view import View
from horizon_dl.readers.registry import open_recording
from horizon_dl.targets.agreement import path_agreement
from horizon_dl.targets.geodesic_params import GEODESIC
from horizon_dl.training.context import AGREEMENT_FRAMES, share_of_deepest
from horizon_dl.training.online import learner as learner_module
from horizon_dl.training.online.learner import FIRST_GUIDED_FRAME, OnlineLearner
from horizon_dl.training.online.running_agreement import ASK_EVERY, RunningAgreement

FRAMES = FIRST_GUIDED_FRAME + ASK_EVERY + 1
QUICK = [
    "online.crop=32",
    "online.batch=2",
    "online.warm_up_steps=1",
    "online.steps_per_frame=1",
    "image.max_pixels=1728",
]


def learned(monkeypatch: pytest.MonkeyPatch, agreement: float, *overrides: str) -> tuple[OnlineLearner, list]:
    """A learner of some frames that was told an agreement, and the shares that its teachers had."""
    shares: list[float | None] = []
    make = learner_module.half_resolution_frame

    def seen(view: Any, config: Any, guide: Any, teacher: Any = None) -> Any:
        shares.append(None if teacher is None else teacher.share)
        return make(view, config, guide, teacher)

    monkeypatch.setattr(learner_module, "half_resolution_frame", seen)
    monkeypatch.setattr(RunningAgreement, "ask", lambda *_: agreement)
    learner = OnlineLearner(load_config(None, [*QUICK, *overrides]))
    for index in range(FRAMES):
        learner.learn(open_recording(toy_set()).read(index))
    return learner, shares


@pytest.mark.parametrize("agreement", [0.3, 0.66, 0.9])
def test_heads_and_teacher_get_the_shares_of_the_last_round(agreement, monkeypatch):
    learner, shares = learned(monkeypatch, agreement)
    deepest = share_of_deepest(agreement)
    assert learner.net.deep_share == pytest.approx(deepest)
    first = next(i for i in range(FIRST_GUIDED_FRAME, FRAMES) if i % ASK_EVERY == 0)
    assert shares[:first] == [None] * first
    assert shares[first:] == [pytest.approx(0.8 * (1 - deepest)) if deepest < 1 else None] * (FRAMES - first)


@pytest.mark.parametrize("override", ["model.start=random", "target.kind=hard", "train.simulated_share=0"])
def test_who_has_no_teacher_offline_has_none_here(override, monkeypatch):
    assert set(learned(monkeypatch, 0.3, override)[1]) == {None}


def test_before_the_first_answer_nothing_changes(monkeypatch):
    learner, shares = learned(monkeypatch, None)
    assert set(shares) == {None}
    assert learner.net.deep_share == 0.5


def test_the_latest_answers_count_and_come_back_from_json():
    rng, asked, mean = np.random.default_rng(0), RunningAgreement(GEODESIC), None
    level = np.repeat(np.linspace(0.3, -0.3, 120, dtype=np.float32)[:, None], 160, axis=1)
    answers = []
    for index in range(2 * AGREEMENT_FRAMES):
        image = rng.integers(0, 256, (120, 160, 3), np.uint8)
        up = np.ones_like(level) if index % 4 == 0 else level  # nothing below the horizon: no answer
        view, p_above = View(image, up), rng.random(level.shape, np.float32)
        answers.append(path_agreement(view, p_above))
        mean = asked.ask(view, p_above)
    state = json.loads(json.dumps(asked.state(), allow_nan=False))
    known = [answer for answer in answers if not np.isnan(answer)]
    assert AGREEMENT_FRAMES < len(known) < len(answers)
    assert state == known[-AGREEMENT_FRAMES:]
    assert mean == pytest.approx(np.mean(state))
    other = RunningAgreement(GEODESIC)
    assert other.mean() is None
    other.load(state)
    assert other.mean() == mean
    for _ in range(2 * AGREEMENT_FRAMES):  # however long nothing is below the horizon
        assert asked.ask(View(image, np.ones_like(level)), p_above) == mean
