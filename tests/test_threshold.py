import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy import ndimage

from horizon_dl.uncertainty.obstacle_map import obstacle_map, without_lone_pixels


def test_lone_pixels_go_and_pairs_stay_diagonal_ones_too():
    picture = ["#....", ".....", "..#..", "...#.", "#...."]
    kept = [".....", ".....", "..#..", "...#.", "....."]
    as_map = [np.array([[c == "#" for c in row] for row in rows]) for rows in (picture, kept)]
    np.testing.assert_array_equal(without_lone_pixels(as_map[0]), as_map[1])


def test_threshold_must_be_exceeded_and_nan_is_no_obstacle():
    score = np.array([[0.5, 0.5, 0.6, 0.6], [np.nan, np.nan, 0.2, 0.2]])
    expected = [[False, False, True, True], [False, False, False, False]]
    np.testing.assert_array_equal(obstacle_map(score, 0.5), expected)


@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=9)))
def test_filter_is_that_of_a_convolution(obstacle):
    kernel = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]])
    neighbours = ndimage.convolve(obstacle.astype(int), kernel, mode="constant")
    np.testing.assert_array_equal(without_lone_pixels(obstacle), obstacle & (neighbours >= 1))


@given(
    arrays(np.float64, (6, 7), elements=st.floats(0.0, 1.0)),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
)
def test_a_higher_threshold_never_adds_obstacles(score, first, second):
    low, high = sorted((first, second))
    assert not (obstacle_map(score, high) & ~obstacle_map(score, low)).any()
