"""Area resizing against OpenCV and float64 sums."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from horizon_dl.geometry.resize import WEIGHT_STEPS, area_resize, area_weights, nearest_pixels


@pytest.mark.parametrize(
    ("image", "size"),
    [((640, 480), (382, 287)), ((1242, 375), (503, 152)), ((64, 48), (32, 24)), ((97, 71), (31, 70))],
)
def test_it_is_opencvs_area_mean_to_one_grey_level(image, size):
    picture = np.random.default_rng(0).integers(0, 256, (image[1], image[0], 3), dtype=np.uint8)
    wanted = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(int)
    found = area_resize(picture, size)
    assert found.dtype == np.uint8
    assert found.shape == (size[1], size[0], 3)
    assert np.abs(found - wanted).max() <= 1  # the two passes round one after the other
    assert (found != wanted).mean() < 0.5


@given(st.integers(1, 300), st.data())
def test_weights_are_the_overlaps_of_pixels(inputs, data):
    outputs = data.draw(st.integers(1, inputs))
    weights = area_weights(inputs, outputs).astype(np.float64)
    assert np.array_equal(weights.sum(axis=1), np.ones(outputs))
    assert np.array_equal(weights * WEIGHT_STEPS, np.round(weights * WEIGHT_STEPS))
    edges = np.arange(outputs + 1) * inputs / outputs
    for output in range(outputs):
        pixel = np.arange(inputs)
        overlap = np.minimum(edges[output + 1], pixel + 1) - np.maximum(edges[output], pixel)
        np.testing.assert_allclose(
            weights[output], overlap.clip(0) * outputs / inputs, atol=1.01 / WEIGHT_STEPS
        )


@given(st.integers(0, 255))
def test_a_plain_image_stays_what_it_is(level):
    assert (area_resize(np.full((23, 31, 3), level, np.uint8), (17, 11)) == level).all()


def test_the_same_size_changes_nothing_and_enlarging_is_refused():
    picture = np.random.default_rng(0).integers(0, 256, (9, 12, 3), dtype=np.uint8)
    assert np.array_equal(area_resize(picture, (12, 9)), picture)
    with pytest.raises(ValueError, match="cannot reduce 12x9 pixels to 13x9"):
        area_resize(picture, (13, 9))


@given(st.integers(1, 400), st.integers(1, 400))
def test_nearest_pixels_are_those_under_the_centres(inputs, outputs):
    found = nearest_pixels(inputs, outputs)
    exact = (np.arange(outputs) + 0.5) * inputs / outputs
    assert (found <= exact + 1e-9).all()
    assert (exact < found + 1 + 1e-9).all()
    assert found.max(initial=0) < inputs
