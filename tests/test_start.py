"""What a net starts from, and what the simulated worlds' net has to say in the last round."""

import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file
from toy import write_toy_set

from horizon_dl.config import Config, ModelConfig, load_config
from horizon_dl.data.evenly import evenly
from horizon_dl.data.view import View
from horizon_dl.models.build import build_net
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.start import OWN, SIMULATED, simulated_net, starting_net, starts_simulated
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.targets.taught import taught_target
from horizon_dl.training.context import before_last_round, share_of_deepest
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.half_resolution import Teacher, half_resolution_target
from horizon_dl.training.online.learner import OnlineLearner
from horizon_dl.training.train import train_run


def test_the_file_holds_all_that_is_learned_and_nothing_else():
    found, net = load_file(SIMULATED), build_net(ModelConfig()).state_dict()
    assert set(found) == set(net) - set(OWN)
    for name, tensor in found.items():
        assert tensor.shape == net[name].shape
        assert torch.isfinite(tensor.float()).all()
    assert SIMULATED.stat().st_size < 300_000


def test_the_small_net_starts_from_the_simulated_worlds_whatever_its_seed_masks_and_dropout():
    nets = []
    for seed, config in ((0, ModelConfig()), (1, ModelConfig(samples=7, dropout=0.5))):
        torch.manual_seed(seed)
        nets.append(starting_net(config))
    for name, tensor in load_file(SIMULATED).items():
        for net in nets:
            assert torch.equal(net.state_dict()[name], tensor)
    assert nets[1].masks.shape[0] == 7
    assert nets[0].deep_share == 0.5


@pytest.mark.parametrize(
    "config", [ModelConfig(start="random"), ModelConfig(channels=8), ModelConfig(kind="mobilenet_v3_small")]
)
def test_every_other_net_starts_at_random(config):
    assert not starts_simulated(config)
    weights = []
    for seed in (0, 1):
        torch.manual_seed(seed)
        weights.append(next(starting_net(config).parameters()))
    assert not torch.equal(*weights)


def auc(score: np.ndarray, positive: np.ndarray) -> float:
    """The chance that an obstacle scores over a floor pixel, counted pair by pair."""
    high, low = score[positive][::97], score[~positive][::97]
    return float(((high[:, None] > low) + 0.5 * (high[:, None] == low)).mean())


def test_it_knows_obstacles_of_a_world_of_a_kind_that_it_was_not_taught_in():
    """The embedded arena, unseen: the net alone, before any learning there."""
    store = FrameStore(open_recording(embedded_set()), Config())
    net = starting_net(ModelConfig()).eval()
    scores, truths = [], []
    for frame, view in store.frames(evenly(range(store.recording.length), 12)):
        if frame.truth is None or frame.truth.shape != view.elevation.shape:
            continue
        known = (view.elevation < 0) & np.isin(frame.truth, (1, 2))
        scores.append(EncodedImage(net, view.image).of_all_depths()[known])
        truths.append((frame.truth == 2)[known])
    assert len(scores) >= 10
    assert auc(np.concatenate(scores), np.concatenate(truths)) > 0.85


def test_a_target_is_mixed_below_the_horizon_alone():
    elevation = np.array([[0.2, -0.2, -0.2, np.nan]])
    target = np.array([[0.9, 0.4, 0.1, np.nan]])
    says = np.array([[0.0, 1.0, 0.0, 0.5]])
    for share, expected in (
        (0.0, [0.9, 0.4, 0.1]),
        (0.25, [0.9, 0.425, 0.075]),
        (1.0, [0.9, 0.5, 0.0]),
    ):
        found = taught_target(target, elevation, says, share)
        np.testing.assert_allclose(found[0, :3], expected)
        assert np.isnan(found[0, 3])


def test_a_teacher_is_asked_for_the_frames_target():
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (40, 60, 3), dtype=np.uint8)
    elevation = np.linspace(0.3, -0.3, 20, dtype=np.float32)[:, None].repeat(30, axis=1)
    says = rng.random((20, 30)).astype(np.float32)
    taught = half_resolution_target(image, elevation, Config(), None, Teacher(lambda *_: says, 0.4))
    plain = half_resolution_target(image, elevation, Config(), None)[::2, ::2].astype(np.float64)
    below = elevation < 0
    np.testing.assert_allclose(taught[::2, ::2][below], (0.6 * plain + 0.2 * says)[below], atol=1e-3)
    np.testing.assert_array_equal(taught[::2, ::2][~below], plain[~below])


@pytest.fixture(scope="module")
def toy(tmp_path_factory):
    return open_recording(write_toy_set(tmp_path_factory.mktemp("toy") / "set"))


@pytest.mark.parametrize("agreement", [None, -0.2, 0.45, 0.6, 0.8, 0.95])
@pytest.mark.parametrize(
    ("start", "target", "teaches"),
    [("simulated", "geodesic", True), ("random", "geodesic", False), ("simulated", "hard", False)],
)
def test_the_teachers_share_falls_as_the_agreement_rises(agreement, start, target, teaches, toy, monkeypatch):
    monkeypatch.setattr("horizon_dl.training.context.agreement_of", lambda *_: agreement)
    config = load_config(None, [f"model.start={start}", f"target.kind={target}"])
    plan = before_last_round(starting_net(config.model).eval(), FrameStore(toy, config), range(toy.length))
    if agreement is None or not teaches:
        assert plan.taught == 0.0
    else:
        assert plan.taught == pytest.approx(
            config.train.simulated_share * (1.0 - share_of_deepest(agreement))
        )
    assert (plan.settings.pastes == 0) == (agreement is not None and agreement >= 0.8)


def test_a_run_says_what_it_started_from_and_learns_otherwise_from_it(toy):
    runs = {
        start: train_run(
            toy,
            load_config(
                None, [f"model.start={start}", "train.rounds=[2, 2]", "train.batch=2", "train.crop=32"]
            ),
        )
        for start in ("simulated", "random")
    }
    for start, run in runs.items():
        assert run.info["start"] == start
    first = [next(run.net.parameters()) for run in runs.values()]
    assert (first[0] - first[1]).abs().max() > 0.01


def test_the_online_learner_has_a_map_before_its_first_frame():
    view = View(np.full((48, 64, 3), 90, np.uint8), np.linspace(0.3, -0.3, 48)[:, None].repeat(64, axis=1))
    net = starting_net(ModelConfig()).eval()
    expected = EncodedImage(net, view.image).samples().mean(axis=0)
    np.testing.assert_allclose(OnlineLearner(Config(), seed=3).predict(view).p_above, expected, atol=1e-5)


def test_the_simulated_worlds_net_is_the_start_made_without_a_random_number(monkeypatch):
    """Not drawn and put back either: another thread may be learning meanwhile."""

    def fail(*_, **__):
        raise AssertionError("the random state was set")

    start = starting_net(ModelConfig()).eval()
    before = torch.get_rng_state()
    with monkeypatch.context() as patch:
        patch.setattr(torch, "set_rng_state", fail)
        patch.setattr(torch.random, "set_rng_state", fail)
        net = simulated_net()
    assert torch.equal(torch.get_rng_state(), before)
    for (name, tensor), expected in zip(net.state_dict().items(), start.state_dict().values(), strict=True):
        assert torch.equal(tensor, expected), name
    image = np.random.default_rng(0).integers(0, 256, (64, 96, 3), dtype=np.uint8)
    asked = [EncodedImage(one, image).of_all_depths() for one in (net, start)]
    np.testing.assert_array_equal(*asked)


@pytest.mark.slow
def test_the_weights_can_be_made_again(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "benchmarks"))
    import simulated_start

    out = tmp_path / "start.safetensors"
    monkeypatch.setattr(
        sys, "argv", ["", "--frames", str(tmp_path), "--worlds", "1", "--steps", "40", "--out", str(out)]
    )
    simulated_start.main()
    assert {name: tensor.shape for name, tensor in load_file(out).items()} == {
        name: tensor.shape for name, tensor in load_file(SIMULATED).items()
    }
