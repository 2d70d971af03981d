import numpy as np
import pytest

from horizon_dl.data.view import View
from horizon_dl.methods.baselines import geodesic_score
from horizon_dl.methods.learners import ForestMethod
from horizon_dl.methods.scores import fused_score, score_maps
from horizon_dl.methods.training_free import training_free_methods
from horizon_dl.targets import geodesic
from horizon_dl.targets.geodesic import (
    horizon_distance,
    path_cost,
    relative_geodesic_position,
    traversal_cost,
)
from horizon_dl.targets.geodesic_params import GeodesicParams
from horizon_dl.uncertainty.measures import measures

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


class OneTree:
    """Stands for a forest."""

    def __init__(self, p_above: np.ndarray) -> None:
        self._p_above = p_above

    def p_above_samples(self, _: View) -> np.ndarray:
        return self._p_above[None]


def test_no_path_is_searched_twice_and_none_for_a_threshold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Net, forest and the geodesic baseline of one frame ask for five paths, every one another."""
    view, p_above = scene()
    searches: list[bytes] = []

    def counted(cost: np.ndarray, seeds: np.ndarray) -> np.ndarray:
        searches.append(cost.tobytes() + seeds.tobytes())
        return path_cost(cost, seeds)

    monkeypatch.setattr(geodesic, "path_cost", counted)
    forest = ForestMethod(OneTree(p_above))
    quick = forest.quick_maps(view)
    assert not searches
    full = forest.score_maps(None, view)
    assert (quick["entropy"] == full["entropy"]).all()
    assert len(searches) == 2
    score_maps(view, measures(1 - p_above[None], view.elevation > 0))
    training_free_methods()["geodesic"].score_maps(None, view)
    assert len(searches) == len(set(searches)) == 5


def test_the_configs_path_costs_reach_every_score() -> None:
    view, p_above = scene()
    costs = GeodesicParams(length_cost=5.0, edge_limit=0.5, sure_share=0.3)
    forest = OneTree(p_above)
    methods = [ForestMethod(forest, one) for one in (GeodesicParams(), costs)]
    usual, other = (method.score_maps(None, view) for method in methods)
    assert np.abs(usual["fused"] - other["fused"]).max() > 0.01
    assert (usual["entropy"] == other["entropy"]).all()
    plain, costly = (geodesic_score(view, one) for one in (GeodesicParams(), costs))
    assert np.abs(plain - costly).max() > 0.01
