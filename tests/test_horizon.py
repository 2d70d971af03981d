"""Horizon: where it lies in the image, for each sign, and its labels."""

import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation, horizon_label
from horizon_dl.geometry.rays import camera_rays

CAMERA = Camera("pinhole", 321, 241, 200.0, 200.0, 160.0, 120.0)


def horizon_rows(roll: float, pitch: float, mount_pitch: float = 0.0) -> np.ndarray:
    """Row (px, sub-pixel) of the horizon in each column."""
    up = up_in_camera(quaternion_from_rpy(roll, pitch, 0.7), (0.0, mount_pitch, 0.0))
    angle = elevation(camera_rays(CAMERA).directions, up)
    assert (np.diff(angle, axis=0) < 0).all()  # elevation falls downwards
    return np.array([np.interp(0.0, -column, np.arange(CAMERA.height)) for column in angle.T])


def test_level_horizon_is_the_row_of_the_principal_point() -> None:
    np.testing.assert_allclose(horizon_rows(0.0, 0.0), 120.0, atol=1e-3)


def test_nose_up_moves_the_horizon_down() -> None:
    np.testing.assert_allclose(horizon_rows(0.0, 0.1), 120.0 + 200.0 * math.tan(0.1), atol=1e-2)


def test_nose_down_moves_the_horizon_up() -> None:
    np.testing.assert_allclose(horizon_rows(0.0, -0.1), 120.0 - 200.0 * math.tan(0.1), atol=1e-2)


def test_mount_looking_down_moves_the_horizon_up() -> None:
    expected = 120.0 - 200.0 * math.tan(math.radians(16.7))
    np.testing.assert_allclose(horizon_rows(0.0, 0.0, math.radians(-16.7)), expected, atol=1e-2)


def test_right_side_down_raises_the_horizon_on_the_right() -> None:
    # The camera turns clockwise, so the world turns counter-clockwise in the image: right end up.
    rows = horizon_rows(0.1, 0.0)
    assert rows[-1] < rows[0]
    np.testing.assert_allclose(rows, 120.0 - math.tan(0.1) * (np.arange(321) - 160.0), atol=1e-2)


def test_elevation_is_an_angle() -> None:
    up = up_in_camera([1, 0, 0, 0], (0.0, 0.0, 0.0))
    angle = elevation(camera_rays(CAMERA).directions, up)
    assert angle.dtype == np.float32
    assert angle[0, 160] == pytest.approx(math.atan(120 / 200), abs=1e-6)
    assert angle[240, 160] == pytest.approx(-math.atan(120 / 200), abs=1e-6)


def test_elevation_against_float64_numpy() -> None:
    rays = np.random.default_rng(0).normal(size=(20, 30, 3))
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    up = np.array([0.6, -0.64, 0.48])
    expected = np.pi / 2 - np.arccos(np.einsum("ijk,k->ij", rays, up))
    np.testing.assert_allclose(elevation(rays.astype(np.float32), up), expected, atol=2e-4)


def test_elevation_of_a_missing_ray_is_missing() -> None:
    rays = np.full((2, 2, 3), np.nan, dtype=np.float32)
    assert np.isnan(elevation(rays, [0.0, -1.0, 0.0])).all()


def test_elevation_of_a_large_image_is_fast() -> None:
    rays = np.zeros((1080, 1920, 3), dtype=np.float32)
    begin = time.perf_counter()
    elevation(rays, [0.0, -1.0, 0.0])
    assert time.perf_counter() - begin < 1.0


def test_labels_by_hand() -> None:
    angle = np.array([[0.2, 0.0, -0.2, np.nan, 0.05, -0.05, 0.1]], dtype=np.float32)
    assert horizon_label(angle).tolist() == [[1, 0, 0, 255, 1, 0, 1]]
    assert horizon_label(angle, 0.06).tolist() == [[1, 255, 0, 255, 255, 255, 1]]
    assert horizon_label(angle).dtype == np.uint8


@settings(max_examples=30, deadline=None)
@given(roll=st.floats(-3, 3), pitch=st.floats(-1.4, 1.4), band=st.floats(0, 0.2))
def test_label_is_one_exactly_above_the_band(roll: float, pitch: float, band: float) -> None:
    angle = elevation(
        camera_rays(CAMERA.scaled(40, 30)).directions,
        up_in_camera(quaternion_from_rpy(roll, pitch, 0), (0, 0, 0)),
    )
    label = horizon_label(angle, band)
    assert set(np.unique(label)) <= {0, 1, 255}
    assert (angle[label == 1] >= band).all()
    assert (angle[label == 0] <= -band).all()
    assert (np.abs(angle[label == 255]) < band).all()


def test_opposite_up_swaps_the_labels() -> None:
    rays = camera_rays(CAMERA).directions
    up = up_in_camera(quaternion_from_rpy(0.3, 0.2, 0.0), (0.0, 0.0, 0.0))
    above, below = horizon_label(elevation(rays, up), 0.01), horizon_label(elevation(rays, -up), 0.01)
    assert ((above == 1) == (below == 0)).all()
