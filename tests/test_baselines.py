import numpy as np
import pytest

from horizon_dl.data.view import View
from horizon_dl.methods.baselines import diffusion_score, geodesic_score, position_score
from horizon_dl.targets.targets import make_target

HEIGHT, WIDTH = 60, 80


@pytest.fixture
def view() -> View:
    """Sky over grass, with a red wall on both sides of the horizon, and a corner without valid rays."""
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    image[:30], image[30:] = (90, 130, 220), (70, 150, 60)
    image[10:48, 30:45] = (180, 70, 50)
    elevation = np.repeat(np.linspace(0.6, -0.6, HEIGHT)[:, None], WIDTH, 1).astype(np.float32)
    elevation[-4:, -4:] = np.nan
    return View(image, elevation)


@pytest.mark.parametrize("score", [diffusion_score, geodesic_score, lambda v: position_score(v.elevation)])
def test_scores_lie_between_0_and_1_and_are_0_where_nothing_is_known(score, view):
    values = score(view)
    assert values.shape == (HEIGHT, WIDTH)
    assert values.dtype == np.float32
    assert ((values >= 0) & (values <= 1)).all()
    assert (values[np.isnan(view.elevation)] == 0).all()


def test_position_falls_strictly_with_depression():
    depression = np.linspace(0.0, np.pi / 2, 10_000, dtype=np.float32)
    score = position_score(-depression[None])[0]
    assert (np.diff(score) < 0).all()
    assert score[0] == 1.0
    assert score[-1] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_array_equal(position_score(depression[None])[0], score)


def test_position_looks_at_no_pixel_value(view):
    rows = position_score(view.elevation)[:, :-4]
    assert (rows == rows[:, :1]).all()


@pytest.mark.parametrize("score", [diffusion_score, geodesic_score])
def test_the_foot_of_the_wall_scores_above_the_floor_beside_it(score, view):
    values = score(view)
    assert values[36:46, 33:42].min() > values[36:46, 5:20].max()


@pytest.mark.parametrize(("score", "kind"), [(diffusion_score, "guided"), (geodesic_score, "geodesic")])
def test_score_is_the_probability_of_the_other_side(score, kind, view):
    target = make_target(kind, view)
    below, above = view.elevation <= 0, view.elevation > 0
    np.testing.assert_array_equal(score(view)[below], target[below])
    np.testing.assert_array_equal(score(view)[above], np.float32(1.0) - target[above])
