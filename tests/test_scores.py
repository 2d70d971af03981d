import numpy as np
import pytest

from horizon_dl.data.view import View
from horizon_dl.methods.scores import fused_score
from horizon_dl.targets.geodesic import horizon_distance, relative_geodesic_position, traversal_cost

HEIGHT, WIDTH = 40, 56


def scene(seed: int = 0) -> tuple[View, np.ndarray]:
    random = np.random.default_rng(seed)
    rise = (HEIGHT / 2 - 0.5 - np.mgrid[0:HEIGHT, 0:WIDTH][0]) / HEIGHT
    image = random.integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8)
    return View(image, np.arctan(rise).astype(np.float32)), random.random((HEIGHT, WIDTH), np.float32)


def test_fused_is_the_sum_of_three_log_odds():
    view, p_above = scene()
    elevation = view.elevation
    cost = traversal_cost(view.image, elevation, p_above)
    share = relative_geodesic_position(cost, elevation, p_above, horizon_distance(cost, elevation)).astype(
        np.float64
    )
    p = np.where(elevation > 0, 1.0 - p_above, p_above).astype(np.float64).clip(0.002, 0.998)
    squeezed = 0.02 + 0.96 * share
    angle = np.abs(elevation).astype(np.float64)
    odds = p / (1 - p) * np.sqrt(squeezed / (1 - squeezed)) * np.exp(-0.5 * angle / angle.mean())
    np.testing.assert_allclose(fused_score(view, p_above), odds / (1 + odds), atol=1e-5)


def test_what_is_far_from_the_sure_floor_is_likelier_an_obstacle():
    """A dark box with the floor's own `p_above`: the frame's edges alone tell it from the floor."""
    view, _ = scene()
    image = np.full((HEIGHT, WIDTH, 3), 150, np.uint8)
    image[26:36, 20:32] = 20
    p_above = np.where(view.elevation > 0, 0.9, 0.1).astype(np.float32)
    fused = fused_score(View(image, view.elevation), p_above)
    assert fused[28:34, 23:29].mean() > 1.5 * fused[28:34, 5:15].mean()


@pytest.mark.parametrize("elevation", [np.nan, 0.0, -0.4, 0.4])
def test_one_side_only_or_none_has_a_score(elevation):
    view, p_above = scene()
    fused = fused_score(View(view.image, np.full_like(view.elevation, elevation)), p_above)
    assert np.isfinite(fused).all()
    assert ((fused >= 0) & (fused <= 1)).all()
