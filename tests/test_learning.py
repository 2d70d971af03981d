from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from toy import write_toy_set

from horizon_dl.config import TrainConfig, TrainerConfig, load_config
from horizon_dl.data.image_folder import FrameFiles
from horizon_dl.errors import FrameError, InputError
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.readers.registry import open_recording
from horizon_dl.training import context, train
from horizon_dl.training.averaging import averaged
from horizon_dl.training.crops import TrainingFrame, draw_batch
from horizon_dl.training.frame_store import FramePool, FrameStore
from horizon_dl.training.half_resolution import half_resolution_frame
from horizon_dl.training.loss import horizon_loss
from horizon_dl.training.online.learner import OnlineLearner
from horizon_dl.training.run_folder import load_run, save_run
from horizon_dl.training.several_processes import processes_of
from horizon_dl.training.train import train_net, train_run

SMALL = [
    "train.rounds=[8, 4]",
    "train.batch=4",
    "train.crop=32",
    "online.warm_up_steps=2",
    "online.batch=4",
    "online.steps_per_frame=2",
]


@pytest.fixture(scope="module")
def config():
    return load_config(None, SMALL)


@pytest.fixture(scope="module")
def toy(tmp_path_factory):
    return open_recording(write_toy_set(tmp_path_factory.mktemp("toy") / "set"))


def frame_of(value: int, shape=(40, 50)) -> TrainingFrame:
    image = np.full((*shape, 3), value, np.uint8)
    return TrainingFrame(image, np.full(shape, value / 255, np.float16), np.ones(shape, bool))


def test_the_loss_is_the_cross_entropy_of_the_pixels_that_count():
    rng = np.random.default_rng(0)
    logits, targets = rng.normal(size=(2, 1, 4, 4)), rng.random((2, 1, 4, 4))
    weights = rng.random((2, 1, 4, 4)) < 0.5
    p = 1 / (1 + np.exp(-logits))
    expected = -(targets * np.log(p) + (1 - targets) * np.log(1 - p))[weights].mean()
    batch = draw_batch([frame_of(0)], 8, rng)._replace(
        targets=torch.from_numpy(targets), weights=torch.from_numpy(weights.astype(float))
    )
    assert float(horizon_loss(torch.from_numpy(logits), batch)) == pytest.approx(expected, rel=1e-6)


def test_crops_keep_image_target_and_mask_together():
    rng = np.random.default_rng(0)
    gradient = rng.integers(0, 256, (40, 50)).astype(np.uint8)
    frame = TrainingFrame(
        np.repeat(gradient[..., None], 3, 2), (gradient / 255).astype(np.float16), gradient > 128
    )
    batch = draw_batch([frame] * 6, 16, rng)
    assert batch.images.shape == (6, 3, 16, 16)
    assert torch.allclose(batch.images[:, :1], batch.targets, atol=1e-3)
    assert torch.equal(batch.weights > 0, batch.images[:, :1] > 128.5 / 255)


def test_pasted_pieces_bring_their_target_and_mask_along():
    rng = np.random.default_rng(0)
    batch = draw_batch([frame_of(value) for value in (10, 100, 200)], 32, rng, pastes=2)
    assert torch.allclose(batch.images[:, :1], batch.targets, atol=1e-3)
    for image in batch.images:
        assert len(image[0].unique()) > 1  # other frames' pieces are in every crop
    plain = draw_batch([frame_of(value) for value in (10, 100, 200)], 32, rng)
    assert all(len(image[0].unique()) == 1 for image in plain.images)


def test_crops_shrink_to_small_frames():
    assert draw_batch([frame_of(1)], 96, np.random.default_rng(0)).images.shape == (1, 3, 40, 50)


def test_pixels_in_the_band_do_not_count(toy, config):
    view = next(FrameStore(toy, config).views([0]))
    frame = half_resolution_frame(view, config, None)
    near = np.abs(view.elevation) < config.labels.band_rad
    assert near.any()
    assert np.array_equal(frame.valid_mask, ~near)


def pool_of(store, rng, *, most=100, memory_mb=64.0, held=None):
    def make(view):
        return half_resolution_frame(view, store.config, None)

    return FramePool(store, range(24), make_frame=make, most=most, memory_mb=memory_mb, rng=rng, held=held)


def test_a_pool_holds_what_is_enough_and_what_fits(toy, config):
    store, rng = FrameStore(toy, config), np.random.default_rng(0)
    whole = pool_of(store, rng)
    assert sorted(whole.held) == list(range(24))
    frame_mb = whole.frames[0].nbytes / 2**20
    enough, another = (pool_of(store, rng, most=5) for _ in range(2))
    assert len(enough.frames) == len(set(enough.held)) == 5
    assert set(enough.held) != set(another.held)
    tight = pool_of(store, rng, memory_mb=4.5 * frame_mb)
    assert len(tight.frames) == 5
    again = pool_of(store, rng, memory_mb=4.5 * frame_mb, held=tight.held)
    assert again.held == tight.held


def test_a_round_makes_no_more_targets_than_its_crops_need(toy, monkeypatch):
    made = []

    def noted(view, *args):
        made.append(view)
        return half_resolution_frame(view, *args)

    monkeypatch.setattr(train, "half_resolution_frame", noted)
    monkeypatch.setattr(context, "LEAST_FRAMES", 1)
    config = load_config(None, [*SMALL, "train.rounds=[4, 2]", "train.batch=6", "train.crops_per_frame=2"])
    train_net(FrameStore(toy, config), range(24), seed=0)
    assert len(made) == 4 * 6 // 2 + 2 * 6 // 2


@pytest.mark.parametrize("processes", [1, 2, 5])
def test_several_processes_learn_from_as_many_frames_as_one_with_all_their_crops(processes):
    settings = TrainConfig(batch=4, crops_per_frame=3)
    each = context.RoundPlan(settings)
    together = context.RoundPlan(settings.model_copy(update={"batch": 4 * processes}))
    for steps in (1, 300):
        assert each.frames(steps, processes) == together.frames(steps)
        assert each.frames(steps, processes) >= max(100, 4 * processes)


@pytest.mark.parametrize(
    ("settings", "count"),
    [({}, 1), ({"devices": 3, "strategy": "ddp"}, 3), ({"devices": 2, "num_nodes": 2}, 4)],
)
def test_processes_are_known_before_they_start(settings, count):
    assert processes_of(TrainerConfig(accelerator="cpu", **settings)) == count


def test_what_was_not_learned_from_is_not_counted(toy, monkeypatch):
    """Few steps, some damaged pictures: what is told is what was learned from, and all that were damaged."""
    monkeypatch.setattr(context, "LEAST_FRAMES", 1)
    damaged = {2, 9, 20}

    def load(index, with_truth):
        if index in damaged:
            raise FrameError(str(index), "is damaged", "restore it")
        return toy.load(index, with_truth)

    run = train_run(replace(toy, load=load), load_config(None, [*SMALL, "train.rounds=[4, 2]"]))
    assert run.info["frames"] <= 4 + 4
    assert {toy.headers[index].name for index in damaged} == set(run.info["skipped"])


@pytest.mark.parametrize("rounds", ["[1]", "[2]", "[3, 10]"])
def test_few_steps_are_enough_for_the_schedule(toy, rounds):
    config = load_config(None, [*SMALL, f"train.rounds={rounds}"])
    net = train_net(FrameStore(toy, config), range(4), seed=0)
    assert all(torch.isfinite(value).all() for value in net.state_dict().values())


def test_training_repeats_to_the_bit(toy, config):
    store = FrameStore(toy, config)
    first, second = (train_net(store, range(20), seed=3) for _ in range(2))
    for a, b in zip(first.state_dict().values(), second.state_dict().values(), strict=True):
        assert torch.equal(a, b)
    other = train_net(store, range(20), seed=4)
    assert not torch.equal(
        first.state_dict()["deep.classifier.weight"], other.state_dict()["deep.classifier.weight"]
    )


def test_training_does_not_touch_the_global_random_state(toy, config):
    state = torch.get_rng_state()
    train_net(FrameStore(toy, config), range(20), seed=3)
    assert torch.equal(state, torch.get_rng_state())


@pytest.mark.slow
def test_the_net_learns_the_toy_horizon(toy):
    config = load_config(None, ["train.rounds=[60]", "train.batch=8", "train.crop=48"])
    store = FrameStore(toy, config)
    net = train_net(store, range(20), seed=0)
    view = next(store.views([22]))
    right = (EncodedImage(net, view.image).single_pass()[0] > 0.5) == (view.elevation > 0)
    assert right.mean() > 0.85


def test_online_learning_lowers_the_loss(toy, config):
    learner = OnlineLearner(config, seed=0)
    store = FrameStore(toy, config)
    losses = [learner.learn(view) for view in store.views(range(24))]
    assert np.mean(losses[-6:]) < losses[0] - 0.03


def test_a_run_comes_back_as_it_was_saved(toy, config, tmp_path):
    run = train_run(toy, config)
    save_run(tmp_path, run)
    loaded = load_run(tmp_path)
    image = next(FrameStore(toy, config).views([0])).image
    assert np.array_equal(
        EncodedImage(loaded.net, image).single_pass(), EncodedImage(run.net, image).single_pass()
    )
    assert loaded.config == config
    assert loaded.threshold == pytest.approx(run.threshold)
    assert 0 < run.threshold < 1


def test_a_damaged_run_is_named(toy, config, tmp_path):
    save_run(tmp_path, train_run(toy, config))
    weights = (tmp_path / "weights.safetensors").read_bytes()
    (tmp_path / "weights.safetensors").write_bytes(weights[: len(weights) // 2])
    with pytest.raises(InputError, match=r"weights\.safetensors"):
        load_run(tmp_path)
    (tmp_path / "weights.safetensors").unlink()
    with pytest.raises(InputError, match=r"lacks weights\.safetensors"):
        load_run(tmp_path)
    with pytest.raises(InputError, match="does not exist"):
        load_run(tmp_path / "nothing")


def test_unreadable_frames_are_skipped_until_they_are_too_many(toy, config):
    def broken(count: int):
        files = [FrameFiles(Path("gone.png"))] * count + list(toy.load.files[count:])
        return FrameStore(replace(toy, load=replace(toy.load, files=tuple(files))), config)

    few = broken(2)
    assert len(list(few.views(range(23, -1, -1)))) == 22
    assert len(few.skipped) == 2
    with pytest.raises(InputError, match="frames cannot be used"):
        list(broken(12).views(range(24)))
    with pytest.raises(InputError, match="4 of 4"):
        list(broken(4).views(range(4)))


def test_the_average_is_the_recursion_by_hand():
    layer = torch.nn.Linear(1, 1, bias=False)
    values = [1.0, 2.0, 5.0, -3.0]
    average = averaged(layer, 0.6)
    expected = None
    for count, value in enumerate(values):
        torch.nn.init.constant_(layer.weight, value)
        average.update_parameters(layer)
        decay = min(0.6, (count + 1) / (count + 10))
        expected = value if expected is None else decay * expected + (1 - decay) * value
    assert average.module.weight.item() == pytest.approx(expected, rel=1e-6)


def test_online_learning_repeats_to_the_bit_and_leaves_the_random_state_alone(toy, config):
    def learned():
        learner = OnlineLearner(config, seed=5)
        losses = [learner.learn(view) for view in FrameStore(toy, config).views(range(14))]
        return losses, learner.single_pass(next(FrameStore(toy, config).views([20])))

    state = torch.get_rng_state()
    (first_losses, first), (second_losses, second) = learned(), learned()
    assert first_losses == second_losses
    assert np.array_equal(first, second)
    assert torch.equal(state, torch.get_rng_state())
