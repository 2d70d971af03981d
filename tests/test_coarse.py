"""Targets at half the size are those of the halved view."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from horizon_dl.config import load_config
from horizon_dl.data.view import View
from horizon_dl.geometry.resize import halved
from horizon_dl.models.build import build_net
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.targets.geodesic import geodesic_target
from horizon_dl.training.half_resolution import (
    guide_of,
    half_resolution_frame,
    half_resolution_target,
)


def a_view(shape=(48, 65)) -> View:
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    elevation = ((shape[0] / 2 - rows) * 0.02).astype(np.float32)
    image = np.where(elevation[..., None] > 0, (150, 190, 230), (90, 100, 60)).astype(np.uint8)
    image[5:40, 20:30] = (200, 90, 30)
    return View(image + (columns % 2).astype(np.uint8)[..., None], elevation)


@given(
    arrays(np.float32, st.tuples(st.integers(2, 9), st.integers(2, 9)), elements=st.floats(-1, 1, width=32))
)
def test_elevation_is_the_mean_of_blocks(elevation):
    half = halved(elevation)
    assert half.shape == (elevation.shape[0] // 2, elevation.shape[1] // 2)
    for row, column in np.ndindex(half.shape):
        block = elevation[2 * row : 2 * row + 2, 2 * column : 2 * column + 2].astype(np.float64)
        assert half[row, column] == pytest.approx(block.mean(), abs=1e-6)


def test_a_pixel_without_ray_spoils_its_block_alone():
    elevation = np.zeros((4, 4), np.float32)
    elevation[0, 3] = np.nan
    assert np.isnan(halved(elevation)).tolist() == [[False, True], [False, False]]


def test_the_coarse_target_is_near_the_fine_one():
    view, config = a_view(), load_config()
    coarse, fine = half_resolution_frame(view, config, None), geodesic_target(view.image, view.elevation)
    assert coarse.target.shape == fine.shape
    assert np.array_equal(coarse.valid_mask, np.abs(view.elevation) >= config.labels.band_rad)
    assert np.abs(coarse.target.astype(float) - fine).mean() < 0.06


@pytest.mark.parametrize("guided", [False, True])
def test_the_coarse_target_is_that_of_the_halved_view(guided):
    view, config = a_view((48, 64)), load_config()
    net = build_net(config.model).eval() if guided else None
    half = view.image.reshape(24, 2, 32, 2, 3).mean(axis=(1, 3)).round().astype(np.uint8)
    p_above = None if net is None else EncodedImage(net, view.image).of_all_depths((24, 32))
    expected = geodesic_target(half, halved(view.elevation), p_above)
    found = half_resolution_target(
        view.image, halved(view.elevation), config, None if net is None else guide_of(net)
    )
    np.testing.assert_allclose(found[::2, ::2], expected, atol=0.02)
    assert np.array_equal(found[::2, ::2], found[1::2, 1::2])
