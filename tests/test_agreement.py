"""Agreement of a learner with the paths, and what hangs on it."""

import json

import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from scipy.stats import spearmanr
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.config import ModelConfig, load_config
from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.evaluation.evaluate import evaluate
from horizon_dl.methods.onnx_file import load_file_run
from horizon_dl.methods.scores import AGREED, fused_score
from horizon_dl.models.build import build_net
from horizon_dl.models.encoded import EncodedImage, image_tensor
from horizon_dl.models.fcn import enlarge
from horizon_dl.readers.registry import open_recording
from horizon_dl.targets.agreement import mean_agreement, path_agreement, rank_correlation_within_bands
from horizon_dl.training import train
from horizon_dl.training.context import agreement_of, all_depths
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.run_folder import WEIGHTS, load_run, save_run, weights
from horizon_dl.training.train import train_net, train_run

SMALL = [
    "train.rounds=[4, 3, 2]",
    "train.batch=4",
    "train.crop=32",
    "train.context_crop=48",
    "train.context_batch=3",
]


@pytest.fixture(autouse=True)
def few_steps_are_enough(monkeypatch):
    monkeypatch.setattr("horizon_dl.training.context.LEAST_STEPS", 0)


def slope(height: int = 60, width: int = 80) -> np.ndarray:
    rise = (height / 3 - np.mgrid[0:height, 0:width][0]) / height
    return np.arctan(rise).astype(np.float32)


def test_the_correlation_is_spearmans_of_each_degree_weighted_by_pixels():
    rng, elevation = np.random.default_rng(0), slope()
    one, other = rng.random((2, *elevation.shape), np.float32)
    other = (other + 0.5 * one).round(1).astype(np.float32)  # with ties
    degree = np.floor(-np.rad2deg(elevation))
    parts = [
        (spearmanr(one[degree == d], other[degree == d])[0], (degree == d).sum())
        for d in range(1, 90)
        if (degree == d).sum() >= 30
    ]
    expected = sum(r * n for r, n in parts) / sum(n for _, n in parts)
    assert rank_correlation_within_bands(one, other, elevation) == pytest.approx(expected, abs=1e-9)


def test_place_alone_and_the_other_side_count_for_nothing():
    """Two maps that agree by depression, and above the horizon, and else are noise."""
    rng, elevation = np.random.default_rng(1), slope(120, 160)
    one, other = (0.01 * rng.random((2, *elevation.shape)) - elevation).astype(np.float32)
    assert np.corrcoef(one.ravel(), other.ravel())[0, 1] > 0.99
    # A degree is some rows here, and these the only ones that order both.
    rows = -np.floor(np.rad2deg(elevation)).astype(np.float32)
    flat_one, flat_other = rows + one + elevation, rows + other + elevation
    assert abs(rank_correlation_within_bands(flat_one, flat_other, elevation)) < 0.05
    above = np.where(elevation > 0, 5.0, flat_one).astype(np.float32)
    assert rank_correlation_within_bands(above, flat_other, elevation) == rank_correlation_within_bands(
        flat_one, flat_other, elevation
    )


def test_nothing_to_compare_is_no_agreement():
    elevation = slope()
    nothing = np.zeros_like(elevation)
    assert np.isnan(rank_correlation_within_bands(nothing, nothing, elevation))
    assert np.isnan(rank_correlation_within_bands(elevation, elevation, np.full_like(elevation, np.nan)))
    assert np.isnan(rank_correlation_within_bands(elevation, elevation, np.abs(elevation)))
    assert mean_agreement([float("nan")]) is None
    assert mean_agreement([]) is None


def wall_and_box(box: bool) -> tuple[View, np.ndarray, np.ndarray]:
    """A dark wall on the left, and a flat thing on the floor: picture, where the wall is, elevation."""
    elevation = slope(96, 128)
    image = np.full((96, 128, 3), 190, np.uint8)
    obstacle = np.zeros((96, 128), bool)
    obstacle[:70, :40] = True
    image[obstacle] = 40
    if box:
        image[60:90, 70:120] = 90
    return View(image, elevation), obstacle, elevation


def test_a_learner_that_sees_the_wall_agrees_and_one_that_sees_blobs_does_not():
    view, obstacle, elevation = wall_and_box(box=False)
    rows, columns = np.mgrid[0:96, 0:128]
    blobs = (np.sin(rows / 3.0) * np.sin(columns / 4.0)) > 0
    sees, dreams = (
        np.where(elevation > 0, 0.95, np.where(thing, 0.45, 0.05)).astype(np.float32)
        for thing in (obstacle, blobs)
    )
    agrees, contradicts = (path_agreement(view, p) for p in (sees, dreams))
    assert agrees > AGREED
    assert contradicts < AGREED - 0.1


@pytest.mark.parametrize("kind", ["fcn", "resnet18"])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_the_deepest_head_has_its_share_of_the_prediction(kind, share):
    torch.manual_seed(0)
    net = build_net(ModelConfig(kind=kind)).eval()
    image = np.random.default_rng(0).integers(0, 256, (61, 83, 3)).astype(np.uint8)
    assert net.deep_share == 0.5
    before = EncodedImage(net, image).single_pass()
    net.weigh_deepest(share)
    assert net.deep_share == pytest.approx(share)
    with torch.no_grad():
        shallow, deep = net(image_tensor(image)).split(1, dim=1)
        logit = (1.0 - share) * shallow + share * deep
        expected = enlarge(logit.sigmoid(), image.shape[:2])[0].numpy()
    np.testing.assert_allclose(EncodedImage(net, image).single_pass(), expected, atol=1e-5)
    assert np.abs(before - expected).max() > 1e-4
    twin = build_net(ModelConfig(kind=kind)).eval()
    twin.load_state_dict(net.state_dict())  # it is kept with the weights
    np.testing.assert_array_equal(EncodedImage(twin, image).samples(), EncodedImage(net, image).samples())
    net.weigh_deepest(0.5)
    np.testing.assert_array_equal(EncodedImage(net, image).single_pass(), before)


@pytest.fixture(scope="module")
def toy(tmp_path_factory):
    return open_recording(write_toy_set(tmp_path_factory.mktemp("toy") / "set"))


@pytest.mark.parametrize(("asked", "trusted"), [("-1", True), ("2", False)])
def test_the_last_round_alone_learns_from_context_where_agreement_suffices(asked, trusted, toy, monkeypatch):
    config = load_config(None, [*SMALL, f"train.context_agreement={asked}"])
    drawn = []

    class Watched(train.CropStream):
        def __init__(self, pool, settings, rng):
            drawn.append((settings.crop, settings.batch, settings.pastes))
            assert settings.learning_rate == config.train.learning_rate
            super().__init__(pool, settings, rng)

    monkeypatch.setattr(train, "CropStream", Watched)
    net = train_net(FrameStore(toy, config), range(toy.length), seed=0)
    if trusted:
        assert net.deep_share == 1.0
    assert drawn == [(32, 4, 3), (32, 4, 3), (48, 3, 0) if trusted else (32, 4, 3)]


@pytest.mark.parametrize(("agreement", "share"), [(None, 0.5), (0.2, 0.0), (0.8, 1.0), (0.7, 0.25 / 0.35)])
def test_without_context_the_deepest_heads_share_follows_the_agreement(agreement, share, toy, monkeypatch):
    config = load_config(None, [*SMALL, "train.context_agreement=2"])
    monkeypatch.setattr("horizon_dl.training.context.agreement_of", lambda *_: agreement)
    net = train_net(FrameStore(toy, config), range(toy.length), seed=0)
    assert net.deep_share == pytest.approx(share)


def test_a_net_of_few_steps_is_not_asked(toy, monkeypatch):
    monkeypatch.setattr("horizon_dl.training.context.LEAST_STEPS", 8)  # 7 come before the last round
    config = load_config(None, [*SMALL, "train.context_agreement=-1"])
    assert train_net(FrameStore(toy, config), range(toy.length), seed=0).deep_share == 0.5


def test_one_round_has_nothing_to_decide_by(toy):
    config = load_config(None, [*SMALL, "train.rounds=[3]", "train.context_agreement=-1"])
    assert train_net(FrameStore(toy, config), range(toy.length), seed=0).deep_share == 0.5


def test_a_run_says_how_far_it_agrees_and_what_it_learned_from(toy):
    config = load_config(None, [*SMALL, "train.context_agreement=-1"])
    run = train_run(toy, config)
    assert run.info["deep_share"] == 1.0
    assert run.info["path_agreement"] == agreement_of(
        all_depths(run.net), FrameStore(toy, config), range(toy.length)
    )


def test_paths_that_contradict_the_learner_are_left_out_of_the_fused_score():
    view, obstacle, elevation = wall_and_box(box=True)
    p_above = np.where(elevation > 0, 0.9, np.where(obstacle, 0.4, 0.1)).astype(np.float32)
    with_paths = fused_score(view, p_above)
    np.testing.assert_array_equal(fused_score(view, p_above, agreement=AGREED), with_paths)
    without = fused_score(view, p_above, agreement=AGREED - 0.01)
    p = np.where(elevation > 0, 1 - p_above, p_above).astype(np.float64)
    angle = np.abs(elevation).astype(np.float64)
    odds = p / (1 - p) * np.exp(-0.5 * angle / angle.mean())
    np.testing.assert_allclose(without, odds / (1 + odds), atol=1e-5)
    assert np.abs(with_paths - without).max() > 0.1


def test_compare_evaluate_and_a_file_leave_out_paths_by_the_same_number(toy, tmp_path, monkeypatch):
    """Of a net whose agreement lies under the limit, and of one whose lies over it."""
    folder, asked = tmp_path / "run", []
    config = load_config(None, SMALL)
    folder.mkdir()
    save_run(folder, train_run(toy, config))
    said = json.loads((folder / "run.json").read_text())["path_agreement"]

    def watched(view, p_above, paths, agreement=None):
        asked.append(agreement)
        return p_above

    monkeypatch.setattr("horizon_dl.methods.scores.fused_score", watched)
    evaluate(load_run(folder), toy)
    assert set(asked) == {said}
    asked.clear()
    main(["export", str(folder), "--out", str(tmp_path / "file"), "-q"])
    evaluate(load_file_run(tmp_path / "file" / "model.onnx"), toy)
    assert set(asked) == {said}


@pytest.mark.parametrize("value", ["0.7", {}, [0.7], float("nan"), 3])
def test_a_damaged_agreement_is_one_line(value, toy, tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    save_run(folder, train_run(toy, load_config(None, SMALL)))
    info = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**info, "path_agreement": value}))
    (folder / "manifest.json").unlink()
    with pytest.raises(InputError, match=r"run.json.*path_agreement"):
        load_run(folder)


def test_a_run_of_before_the_heads_had_shares_says_so(toy, tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    run = train_run(toy, load_config(None, SMALL))
    save_run(folder, run)
    kept = {name: tensor for name, tensor in weights(run.net).items() if name != "head_weights"}
    save_file(kept, folder / WEIGHTS)
    (folder / "manifest.json").unlink()
    with pytest.raises(InputError, match=r"of another version \(.*head_weights.*train again"):
        load_run(folder)
