import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage, sparse
from scipy.sparse.csgraph import dijkstra

from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.targets.geodesic import (
    confident_seeds,
    geodesic_target,
    horizon_distance,
    horizon_seeds,
    nearness,
    one_way_target,
    relative_geodesic_position,
    traversal_cost,
)
from horizon_dl.targets.geodesic_params import GEODESIC
from horizon_dl.targets.guided import guided_target
from horizon_dl.targets.hard import hard_target
from horizon_dl.targets.targets import TARGETS, make_target

HEIGHT, WIDTH = 40, 56


def level_elevation(height: int = HEIGHT, width: int = WIDTH, roll_rad: float = 0.0) -> np.ndarray:
    """Elevation of a flat picture plane, horizon through its middle, tilted by the roll."""
    v, u = np.mgrid[0:height, 0:width].astype(np.float32)
    rise = (height / 2 - 0.5 - v) * np.cos(roll_rad) + (u - width / 2 + 0.5) * np.sin(roll_rad)
    return np.arctan(rise / height).astype(np.float32)


def noise_image(seed: int = 0, height: int = HEIGHT, width: int = WIDTH) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(size=(height, width, 3))
    smooth = ndimage.gaussian_filter(noise, (2, 2, 0))
    return np.clip(127 + 400 * smooth, 0, 255).astype(np.uint8)


def room(height: int = 120, width: int = 160) -> np.ndarray:
    """Sky, grass, and in the middle a brick-red wall that stands on both sides."""
    image = np.zeros((height, width, 3), np.uint8)
    image[: height // 2], image[height // 2 :] = (90, 130, 220), (70, 150, 60)
    image[height // 5 : height * 4 // 5, width // 3 : width // 2] = (180, 70, 50)
    return image


@pytest.fixture(params=list(TARGETS))
def kind(request) -> str:
    return request.param


@pytest.mark.parametrize("roll_rad", [0.0, 0.3, -1.2, 3.0])
def test_targets_are_probabilities_and_know_the_side_of_far_pixels(kind, roll_rad):
    view = View(noise_image(), level_elevation(roll_rad=roll_rad))
    target = make_target(kind, view)
    assert target.shape == (HEIGHT, WIDTH)
    assert target.dtype == np.float32
    assert ((target >= 0) & (target <= 1)).all()
    assert target[view.elevation > 0.2].mean() > 0.6
    assert target[view.elevation < -0.2].mean() < 0.4


@pytest.mark.parametrize(("offset", "side"), [(2.0, 1.0), (-2.0, 0.0)])
def test_without_a_horizon_in_the_image_all_is_hard(kind, offset, side):
    view = View(noise_image(), level_elevation() * 0.5 + np.float32(offset / 2))
    np.testing.assert_allclose(make_target(kind, view), side, atol=1e-4)


def test_nan_where_the_ray_is_not_valid_and_nowhere_else(kind):
    elevation = level_elevation()
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH]
    invalid = np.hypot(v - HEIGHT / 2, u - WIDTH / 2) > 22
    elevation[invalid] = np.nan
    np.testing.assert_array_equal(np.isnan(make_target(kind, View(noise_image(), elevation))), invalid)


def test_nothing_valid_gives_nothing(kind):
    view = View(noise_image(), np.full((HEIGHT, WIDTH), np.nan, np.float32))
    assert np.isnan(make_target(kind, view)).all()


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (3, 200), (200, 3), (241, 33)])
def test_any_size_works(kind, size):
    view = View(noise_image(0, *size), level_elevation(*size))
    assert np.isfinite(make_target(kind, view)).all()


def test_targets_change_nothing_and_repeat_themselves(kind):
    image, elevation = noise_image(), level_elevation(roll_rad=0.2)
    image.setflags(write=False)
    elevation.setflags(write=False)
    view = View(image, elevation)
    np.testing.assert_array_equal(make_target(kind, view), make_target(kind, view))


def test_unknown_kind_says_which_there_are():
    view = View(noise_image(), level_elevation())
    with pytest.raises(InputError, match="use one of hard, guided, one_way_geodesic, geodesic"):
        make_target("soft", view)


def test_hard_target_leaves_out_the_band():
    elevation = np.array([[0.3, 0.05, -0.05, -0.3, np.nan]], np.float32)
    image = np.zeros((1, 5, 3), np.uint8)
    np.testing.assert_array_equal(hard_target(image, elevation), [[1, 1, 0, 0, np.nan]])
    np.testing.assert_array_equal(
        hard_target(image, elevation, band_rad=0.1), [[1, np.nan, np.nan, 0, np.nan]]
    )


@pytest.mark.parametrize("kind", ["guided", "geodesic"])
def test_a_wall_through_the_horizon_is_mixed_and_its_floor_is_not(kind):
    image = room()
    view = View(image, level_elevation(120, 160))
    target = make_target(kind, view)
    wall_foot, floor = target[75:90, 60:75], target[75:115, 5:40]
    assert np.median(wall_foot) > 0.2
    assert np.median(floor) < np.median(wall_foot) - 0.1
    assert np.median(target[100:115, 5:40]) < 0.16
    wall_top = target[30:45, 60:75]
    np.testing.assert_allclose(np.median(wall_top), 1.0 - np.median(wall_foot), atol=0.1)


# Guided filter


def guided_by_hand(image, label, rows: int, columns: int, eps: float) -> np.ndarray:
    """He et al. 2013, eq. 14 to 16, in float64, with a mirrored border that does not repeat the edge."""

    def mean(values: np.ndarray) -> np.ndarray:
        size = (2 * rows + 1, 2 * columns + 1) + (1,) * (values.ndim - 2)
        return ndimage.uniform_filter(values, size, mode="mirror")

    guide = image.astype(np.float64) / 255.0
    mean_guide, mean_label = mean(guide), mean(label)
    products = guide[..., :, None] * guide[..., None, :]
    sigma = mean(products) - mean_guide[..., :, None] * mean_guide[..., None, :]
    covariance = mean(guide * label[..., None]) - mean_guide * mean_label[..., None]
    a = np.linalg.solve(sigma + eps * np.eye(3), covariance[..., None])[..., 0]
    b = mean_label - (a * mean_guide).sum(axis=-1)
    return np.clip((mean(a) * guide).sum(axis=-1) + mean(b), 0.0, 1.0)


def test_guided_target_is_the_guided_filter_of_the_hard_label():
    image, elevation = noise_image(), level_elevation(roll_rad=0.2)
    got = guided_target(image, elevation, reach_vertical=0.25, reach_sideways=0.1, eps=0.01)
    expected = guided_by_hand(image, (elevation > 0).astype(np.float64), rows=10, columns=4, eps=0.01)
    np.testing.assert_allclose(got, expected, atol=1e-4)


def test_guided_target_on_fewer_rows_is_nearly_the_same():
    view = View(noise_image(3, 120, 160), level_elevation(120, 160))
    difference = guided_target(view.image, view.elevation, statistics_rows=60) - guided_target(
        view.image, view.elevation
    )
    assert 0 < np.abs(difference).mean() < 0.02


def test_unknown_pixels_do_not_pull_the_guided_target_to_a_side():
    image, elevation = np.full((HEIGHT, WIDTH, 3), 100, np.uint8), level_elevation()
    holed = elevation.copy()
    holed[:, :8] = np.nan
    got, whole = guided_target(image, holed), guided_target(image, elevation)
    np.testing.assert_allclose(got[:, 8:], whole[:, 8:], atol=1e-5)


# Geodesic


def dijkstra_distance(cost: np.ndarray, seeds: np.ndarray) -> np.ndarray:
    """Shortest way over the 8-neighbour grid; a step costs the mean of its ends times its length."""
    height, width = cost.shape
    index = np.arange(cost.size).reshape(cost.shape)
    graph = sparse.lil_matrix((cost.size, cost.size))
    for dr, dc in [(0, 1), (1, 0), (1, 1), (1, -1)]:
        for r in range(height - dr):
            for c in range(max(0, -dc), width - max(0, dc)):
                step = 0.5 * (cost[r, c] + cost[r + dr, c + dc]) * np.hypot(dr, dc)
                if np.isfinite(step):
                    graph[index[r, c], index[r + dr, c + dc]] = step
    ways = dijkstra(graph.tocsr(), directed=False, indices=index[seeds], min_only=True)
    return ways.reshape(cost.shape)


def test_horizon_distance_is_dijkstras():
    image, elevation = noise_image(1, 18, 22), level_elevation(18, 22, roll_rad=0.4)
    elevation[6:14, 4] = np.nan
    cost = traversal_cost(image, elevation)
    got = horizon_distance(cost, elevation)
    assert (np.isinf(cost) == np.isnan(elevation)).all()
    expected = dijkstra_distance(cost, horizon_seeds(elevation))
    valid = ~np.isnan(elevation)
    np.testing.assert_allclose(got[valid], expected[valid], rtol=1e-4, atol=1e-6)


def test_the_step_cost_against_its_formula():
    """In float64 with OpenCV's Lab and blur."""
    image = noise_image(3, 60, 80)
    lab = cv2.cvtColor((image / 255).astype(np.float32), cv2.COLOR_RGB2LAB).astype(np.float64)
    sigma = GEODESIC.blur * np.sqrt(60 * 80)
    smooth = cv2.GaussianBlur(
        lab * (1, GEODESIC.chroma, GEODESIC.chroma), (0, 0), sigma, borderType=cv2.BORDER_REFLECT
    )
    down, right = np.gradient(smooth, axis=(0, 1))
    gradient = np.sqrt((down**2 + right**2).sum(-1))
    inner = (slice(4, -4), slice(4, -4))
    expected = 0.1 + np.minimum((gradient / gradient.mean()) ** 1.5, 6.0)
    got = traversal_cost(image, level_elevation(60, 80))
    np.testing.assert_allclose(got[inner], expected[inner], rtol=0.08)


def test_a_flat_image_costs_its_length_alone():
    grey = np.full((41, 30, 3), 128, np.uint8)
    elevation = level_elevation(41, 30) + np.float32(1e-3)  # horizon between rows 20 and 21
    steps = np.r_[20:-1:-1, 0:20]
    relative = steps / np.arange(20).mean()
    near = nearness(horizon_distance(traversal_cost(grey, elevation), elevation), elevation)
    np.testing.assert_allclose(near[:, 7], np.exp(-relative), atol=1e-5)
    target = geodesic_target(grey, elevation)
    np.testing.assert_allclose(target[40, 7], 0.5 * np.exp(-relative[40]), rtol=1e-4)
    np.testing.assert_allclose(target[0, 7], 1 - 0.5 * np.exp(-relative[0]), rtol=1e-4)


def test_behind_an_edge_the_label_is_plainer():
    image = room()
    target = geodesic_target(image, level_elevation(*image.shape[:2]))
    wall, grass = target[90, 66], target[90, 20]
    behind = target[112, 66]  # the grass below the wall, behind its lower edge
    assert wall > 2 * behind
    assert grass > behind


@pytest.mark.parametrize("factor", [2, 3])
def test_resolution_hardly_matters(factor):
    image = room()
    large = np.kron(image, np.ones((factor, factor, 1), np.uint8))
    small_target = geodesic_target(image, level_elevation(*image.shape[:2]))
    large_target = geodesic_target(large, level_elevation(*large.shape[:2]))
    assert np.abs(large_target[factor // 2 :: factor, factor // 2 :: factor] - small_target).mean() < 0.03


@pytest.mark.parametrize("contrast", [0.5, 0.8])
def test_contrast_hardly_matters(contrast):
    image = room().astype(float)
    faint = (128 + contrast * (image - 128)).astype(np.uint8)
    elevation = level_elevation(*image.shape[:2])
    difference = geodesic_target(faint, elevation) - geodesic_target(room(), elevation)
    assert np.abs(difference).mean() < 0.03


def test_no_path_leads_through_invalid_rays():
    elevation = level_elevation()
    elevation[30] = np.nan
    target = geodesic_target(np.full((HEIGHT, WIDTH, 3), 90, np.uint8), elevation)
    assert (target[20:30] > 0.05).all()
    assert (target[31:] == 0.0).all()


def test_seeds_lie_on_both_sides_of_the_horizon_and_not_at_gaps():
    elevation = np.array([[1, 1, np.nan], [1, -1, -1], [-1, -1, -1]], np.float32)
    expected = [[False, True, False], [True, True, False], [True, False, False]]
    np.testing.assert_array_equal(horizon_seeds(elevation), expected)


def test_way_share_is_dijkstras():
    elevation = level_elevation(18, 22, roll_rad=0.4)
    elevation[6:14, 4] = np.nan
    image, p_above = noise_image(1, 18, 22), np.nan_to_num(0.5 + elevation).clip(0.01, 0.99)
    cost, horizon = traversal_cost(image, elevation, p_above), horizon_seeds(elevation)
    to_horizon = dijkstra_distance(cost, horizon)
    got = relative_geodesic_position(cost, elevation, p_above, to_horizon)
    own_side = confident_seeds(elevation, p_above)
    expected = np.zeros(cost.shape)
    for side in (elevation > 0, elevation <= 0):
        to_sure = dijkstra_distance(np.where(side & ~horizon, cost, np.inf), side & own_side & ~horizon)
        inner = side & ~horizon & np.isfinite(to_sure)
        expected[inner] = to_sure[inner] / (to_sure + to_horizon)[inner]
    expected[horizon] = 1.0
    valid = ~np.isnan(elevation)
    np.testing.assert_allclose(got[valid], expected[valid], rtol=1e-4, atol=1e-5)
    assert (got[own_side & ~horizon] == 0.0).all()


def test_sure_is_what_the_net_says_and_of_equals_what_lies_further_off():
    elevation = level_elevation()
    p_above = np.where(elevation > 0, 0.9, 0.1).astype(np.float32)
    lowest = confident_seeds(elevation, p_above)
    assert np.unique(np.nonzero(lowest)[0]).tolist() == [0, 39]
    p_above[25, 10:40] = 0.002
    assert confident_seeds(elevation, p_above)[25, 10:40].all()


def test_the_way_to_the_sure_floor_speaks_for_a_low_obstacle():
    """A box on the floor, lower than the camera: edges part it from the horizon and from the floor alike."""
    image = np.full((120, 160, 3), 200, np.uint8)
    image[60:] = (120, 130, 110)
    image[75:105, 60:100] = (40, 30, 90)
    elevation = level_elevation(*image.shape[:2])
    p_above = np.where(elevation > 0, 0.95, 0.05).astype(np.float32)
    p_above[75:105, 60:100] = 0.15
    floor, box = (slice(75, 105), slice(5, 45)), (slice(80, 100), slice(65, 95))
    one_way = one_way_target(image, elevation, p_above)
    cost = traversal_cost(image, elevation, p_above)
    share = relative_geodesic_position(cost, elevation, p_above, horizon_distance(cost, elevation))
    both_ways = geodesic_target(image, elevation, p_above)
    assert share[box].mean() > 2.5 * share[floor].mean()
    gaps = [target[floor].mean() - target[box].mean() for target in (one_way, both_ways)]
    assert 0 < gaps[1] < 0.2 * gaps[0]


def test_learned_edges_are_dear():
    """A net that parts a flat image in two: the way across costs its edge, and half of the image's counts."""
    flat, elevation = np.full((60, 80, 3), 128, np.uint8), level_elevation(60, 80)
    p_above = np.full((60, 80), 0.1, np.float32)
    p_above[:, 40:] = 0.6
    blur_px = GEODESIC.blur * np.sqrt(60 * 80) / 2
    odds = cv2.GaussianBlur(
        np.log(p_above / (1 - p_above)).astype(np.float64), (0, 0), blur_px, borderType=cv2.BORDER_REFLECT
    )
    gradient = np.abs(np.gradient(odds, axis=1))
    expected = 0.1 + np.minimum((gradient / gradient.mean()) ** 1.5, 6.0)
    inner = (slice(4, -4), slice(4, -4))
    np.testing.assert_allclose(traversal_cost(flat, elevation, p_above)[inner], expected[inner], rtol=0.08)
    image = noise_image(3, 60, 80)
    unsure = np.full((60, 80), 0.5, np.float32)
    halved = 0.1 + (traversal_cost(image, elevation) - 0.1) / 2
    np.testing.assert_allclose(traversal_cost(image, elevation, unsure), halved, rtol=1e-4)


@pytest.mark.parametrize("learning", ["one_way_geodesic", "geodesic"])
def test_what_the_net_says_reaches_the_target(learning):
    view = View(noise_image(), level_elevation())
    p_above = np.random.default_rng(2).random((HEIGHT, WIDTH), np.float32)
    target = make_target(learning, view, p_above)
    np.testing.assert_array_equal(target, TARGETS[learning](view.image, view.elevation, p_above))
    assert np.abs(target - make_target(learning, view)).mean() > 0.01


def test_nothing_sure_in_reach_says_nothing_and_no_horizon_is_plain():
    elevation = level_elevation()
    elevation[25] = np.nan  # what is sure lies beyond
    cost = np.ones(elevation.shape, np.float32)
    cost[25] = np.inf
    unsure = np.full(elevation.shape, 0.5, np.float32)
    share = relative_geodesic_position(cost, elevation, unsure, horizon_distance(cost, elevation))
    assert (share[19:21] == 1.0).all()
    assert (share[21:25] == 0.5).all()
    assert (share[26:] == 0.0).all()
    astray = np.full(elevation.shape, np.nan, np.float32)
    assert np.isfinite(geodesic_target(noise_image(), level_elevation(), astray)).all()
    below = np.full((HEIGHT, WIDTH), -0.3, np.float32)
    assert (geodesic_target(noise_image(), below, np.full(below.shape, 0.2, np.float32)) == 0.0).all()


@settings(max_examples=20, deadline=None)
@given(st.floats(-3.1, 3.1), st.integers(0, 5), st.booleans())
def test_geodesic_target_never_crosses_a_half(roll_rad, seed, learned):
    elevation = level_elevation(20, 24, roll_rad)
    p_above = np.random.default_rng(seed).random((20, 24), np.float32) if learned else None
    target = geodesic_target(noise_image(seed, 20, 24), elevation, p_above)
    assert (target[elevation > 0] >= 0.5).all()
    assert (target[elevation <= 0] <= 0.5).all()


def test_targets_turn_with_the_image(kind):
    image, elevation = noise_image(), level_elevation()
    mirrored = make_target(kind, View(image[:, ::-1], elevation[:, ::-1]))
    np.testing.assert_allclose(mirrored[:, ::-1], make_target(kind, View(image, elevation)), atol=1e-4)
