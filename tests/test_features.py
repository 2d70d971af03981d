import colorsys

import cv2
import numpy as np
import pytest

from horizon_dl.models.features import FEATURE_NAMES, laws_responses, pixel_features, uniform_lbp


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (24, 31, 3), dtype=np.uint8)


def grey_of(image: np.ndarray) -> np.ndarray:
    return (image @ np.array([0.2125, 0.7154, 0.0721]) / 255.0).astype(np.float32)


def test_shape_type_and_names(image):
    features = pixel_features(image)
    assert features.shape == (24, 31, 13)
    assert features.dtype == np.float32
    assert len(FEATURE_NAMES) == len(set(FEATURE_NAMES)) == 13
    assert np.isfinite(features).all()


def test_hsv_is_that_of_the_standard_library(image):
    features = pixel_features(image)
    for row, column in [(0, 0), (5, 7), (23, 30)]:
        expected = colorsys.rgb_to_hsv(*(image[row, column] / 255.0))
        np.testing.assert_allclose(features[row, column, :3], expected, atol=1e-6)


@pytest.mark.parametrize("index", range(9))
def test_laws_masks_are_outer_products(image, index):
    level, edge, spot = [1, 2, 1], [-1, 0, 1], [-1, 2, -1]
    masks = [np.outer(v, h) for v in (level, edge, spot) for h in (level, edge, spot)]
    flipped = masks[index][::-1, ::-1].astype(np.float64)  # OpenCV correlates
    expected = cv2.filter2D(grey_of(image).astype(np.float64), -1, flipped, borderType=cv2.BORDER_REFLECT)
    np.testing.assert_allclose(pixel_features(image)[..., 4 + index], expected, atol=1e-5)


def test_laws_masks_but_the_first_ignore_brightness():
    responses = laws_responses(np.full((9, 9), 0.7, np.float32))
    np.testing.assert_allclose(responses[..., 0], 16 * 0.7, rtol=1e-6)
    np.testing.assert_allclose(responses[..., 1:], 0.0, atol=1e-6)


def lbp_by_hand(levels: np.ndarray, row: int, column: int) -> int:
    """Uniform pattern at a pixel away from the border, by its definition (Ojala et al. 2002)."""
    angles = 2 * np.pi * np.arange(24) / 24
    rows, columns = row - 3 * np.sin(angles), column + 3 * np.cos(angles)
    r0, c0 = np.floor(rows + 1e-9).astype(int), np.floor(columns + 1e-9).astype(int)
    fr, fc = np.round(rows - r0, 9), np.round(columns - c0, 9)
    top = levels[r0, c0] * (1 - fc) + levels[r0, c0 + 1] * fc
    bottom = levels[r0 + 1, c0] * (1 - fc) + levels[r0 + 1, c0 + 1] * fc
    bits = top * (1 - fr) + bottom * fr >= levels[row, column]
    changes = np.sum(bits != np.roll(bits, 1))
    return int(bits.sum()) if changes <= 2 else 25


def test_lbp_follows_its_definition():
    # Smooth and of many levels: uniform patterns occur, and no point ties with its centre by rounding.
    y, x = np.mgrid[0:40, 0:40]
    levels = np.rint(127 + 60 * np.sin(x / 4.3 + 0.2 * y) + 60 * np.cos(y / 5.1)).astype(np.float64)
    pattern = uniform_lbp((levels / 255.0).astype(np.float32))
    pixels = [(r, c) for r in range(6, 34) for c in range(6, 34)]
    agree = [pattern[r, c] == lbp_by_hand(levels, r, c) for r, c in pixels]
    assert np.mean(agree) > 0.99
    assert len(np.unique(pattern)) > 5


def test_lbp_of_a_flat_surface_is_all_points():
    assert (uniform_lbp(np.full((20, 20), 0.3, np.float32))[4:-4, 4:-4] == 24).all()


def test_input_stays_as_it_is(image):
    before = image.copy()
    pixel_features(image)
    np.testing.assert_array_equal(image, before)
