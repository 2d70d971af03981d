import numpy as np
import pytest

from horizon_dl.data.view import View, make_view
from horizon_dl.errors import InputError
from horizon_dl.evaluation.protocols import split_frames
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.metrics.scored_pixels import enlarged, scored_pixels
from horizon_dl.models.features import pixel_features
from horizon_dl.models.forest import HorizonForest, draw_view_pixels
from horizon_dl.readers.registry import open_recording
from horizon_dl.uncertainty.measures import binary_entropy


def make_scene(seed: int, height: int = 36, width: int = 48) -> View:
    """Blue above, green below, a red stripe across both sides."""
    rng = np.random.default_rng(seed)
    elevation = np.repeat(np.linspace(0.5, -0.5, height)[:, None], width, 1).astype(np.float32)
    colour = np.where(elevation[..., None] > 0, (60, 90, 200), (60, 160, 60))
    colour[:, width // 3 : width // 2] = (190, 60, 60)
    image = np.clip(colour + rng.normal(0, 8, colour.shape), 0, 255).astype(np.uint8)
    return View(image, elevation)


@pytest.fixture(scope="module")
def views() -> list[View]:
    return [make_scene(seed) for seed in range(4)]


@pytest.fixture(scope="module")
def forest(views) -> HorizonForest:
    return HorizonForest.fit(views, seed=0, training_pixels=4000, n_jobs=1)


def test_samples_average_to_the_forests_probability(forest, views):
    view = make_scene(9)
    samples = forest.p_above_samples(view)
    expected = forest.classifier.predict_proba(pixel_features(view.image).reshape(-1, 13))[:, 1]
    assert samples.shape == (20, 36, 48)
    assert samples.dtype == np.float32
    np.testing.assert_allclose(samples.mean(axis=0).ravel(), expected, atol=1e-6)
    np.testing.assert_allclose(forest.p_above_samples(view).mean(axis=0).ravel(), expected, atol=1e-6)


def test_sure_of_floor_and_sky_and_unsure_of_what_stands_on_both_sides(forest):
    view = make_scene(9)
    p = forest.p_above_samples(view).mean(axis=0)
    assert np.median(p[:14, :12]) > 0.9
    assert np.median(p[22:, :12]) < 0.1
    assert 0.25 < np.median(p[22:, 18:22]) < 0.75


def test_settings_are_the_papers(forest):
    assert len(forest.classifier.estimators_) == 20
    for tree in forest.classifier.estimators_:
        leaves = tree.tree_.children_left == -1
        assert tree.tree_.n_node_samples[leaves].min() >= 10
    assert forest.classifier.min_samples_leaf == 10
    assert forest.classifier.max_depth is None


def test_same_seed_same_forest_other_seed_another(forest, views):
    view = make_scene(9)
    again = HorizonForest.fit(views, seed=0, training_pixels=4000, n_jobs=2)
    other = HorizonForest.fit(views, seed=1, training_pixels=4000, n_jobs=1)
    np.testing.assert_array_equal(again.p_above_samples(view), forest.p_above_samples(view))
    assert not np.array_equal(other.p_above_samples(view), forest.p_above_samples(view))


def test_drawn_pixels_lie_outside_the_band_on_valid_rays_and_are_not_repeated():
    height, width = 20, 30
    image = np.zeros((height, width, 3), np.uint8)
    image[..., 2] = np.arange(height)[:, None] * 10  # value tells the row
    elevation = np.repeat(np.linspace(0.5, -0.5, height)[:, None], width, 1).astype(np.float32)
    elevation[3] = np.nan
    view = View(image, elevation)
    features, labels = draw_view_pixels(view, 0, band_rad=0.2, count=10_000)
    rows = np.rint(features[:, 2] * 255 / 10).astype(int)
    usable = [r for r in range(height) if r != 3 and abs(elevation[r, 0]) >= 0.2]
    assert sorted(set(rows)) == usable
    assert len(rows) == len(usable) * width
    np.testing.assert_array_equal(labels, elevation[rows, 0] > 0)


def test_every_view_gives_the_same_number_of_pixels(monkeypatch, views):
    from horizon_dl.models import forest as module

    counts = []

    def spy(view, seed, band_rad, count):
        drawn = draw_view_pixels(view, seed, band_rad, count)
        counts.append(len(drawn[1]))
        return drawn

    monkeypatch.setattr(module, "draw_view_pixels", spy)
    HorizonForest.fit(views, seed=0, training_pixels=1000, trees=1, n_jobs=1)
    assert counts == [250] * 4


def test_one_side_only_is_refused(views):
    below = [View(v.image, -np.abs(v.elevation) - 0.1) for v in views]
    with pytest.raises(InputError, match="not from both sides of the horizon"):
        HorizonForest.fit(below, seed=0)
    with pytest.raises(InputError, match="not from both sides of the horizon"):
        HorizonForest.fit([], seed=0)


def test_leaves_as_onnx(forest):
    import onnxruntime
    import skl2onnx

    view = make_scene(9)
    features = pixel_features(view.image).reshape(-1, 13)
    model = skl2onnx.to_onnx(forest.classifier, features[:1], options={"zipmap": False})
    session = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    probability = session.run(None, {session.get_inputs()[0].name: features})[1][:, 1]
    np.testing.assert_allclose(probability, forest.p_above_samples(view).mean(axis=0).ravel(), atol=1e-5)


# Entropy, pooled AUC below the horizon, of the method's published features on these sets: a forest that falls
# short of it would be an easy rival.
@pytest.mark.slow
@pytest.mark.long
@pytest.mark.real_data
@pytest.mark.parametrize(
    ("folder", "max_pixels", "least", "most"),
    [
        ("hallway", 76_800, 0.75, 0.81),
        ("kitti", 117_000, 0.65, 0.73),
    ],
)
def test_forest_is_as_strong_as_it_should_be(data_dir, folder, max_pixels, least, most):
    recording = open_recording(data_dir / folder)
    split = split_frames("labelled-out", [entry.labelled for entry in recording.headers])
    train = [make_view(recording.read(i), max_pixels) for i in split.train[::2]]
    forest = HorizonForest.fit(train, seed=0)
    roc = RocAccumulator()
    for frame in (recording.read(i) for i in split.test):
        view, pixels = make_view(frame, max_pixels), scored_pixels(frame)
        assert pixels is not None
        score = enlarged(binary_entropy(forest.p_above_samples(view).mean(axis=0)), pixels.mask.shape)[
            pixels.mask
        ]
        roc.update(score, pixels.obstacle, pixels.depression_rad)
    result = roc.compute()
    assert result.auc is not None
    assert least < result.auc < most
