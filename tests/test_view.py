"""Views: size, area resize, elevation at the small size."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from horizon_dl.data.frame import Frame
from horizon_dl.data.view import make_view
from horizon_dl.errors import FrameError
from horizon_dl.geometry.camera import Camera, working_size

CAMERA = Camera("pinhole", 64, 48, 50.0, 50.0, 31.5, 23.5)
UP = np.array([0.0, -1.0, 0.0])


def frame(up_cam: np.ndarray | None = UP) -> Frame:
    image = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    return Frame("a.png", 1.5, up_cam, image=image, camera=CAMERA)


@given(st.integers(1, 4000), st.integers(1, 3000), st.integers(1, 500_000))
def test_working_size_is_small_enough_and_never_larger(width: int, height: int, most: int) -> None:
    w, h = working_size(width, height, most)
    assert 1 <= w <= width
    assert 1 <= h <= height
    assert w * h <= max(most, width, height)
    if min(w, h) > 30:
        assert w / h == pytest.approx(width / height, rel=0.05)


def test_working_size_of_known_cameras() -> None:
    assert working_size(640, 480, 320 * 240) == (320, 240)
    assert working_size(64, 48, 320 * 240) == (64, 48)


def test_image_is_the_mean_over_areas() -> None:
    view = make_view(frame(), 32 * 24)
    blocks = frame().image.reshape(24, 2, 32, 2, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(view.image, blocks, atol=1.01)  # Pillow rounds twice
    assert view.image.dtype == np.uint8


def test_elevation_matches_the_full_size_between_its_pixels() -> None:
    small, full = make_view(frame(), 32 * 24).elevation, make_view(frame(), 10**6).elevation
    assert small.shape == (24, 32)
    assert full.shape == (48, 64)
    np.testing.assert_allclose(small, full.reshape(24, 2, 32, 2).mean(axis=(1, 3)), atol=1e-3)
    assert full[23, 0] > 0 > full[24, 0]


def test_frame_without_attitude_is_refused() -> None:
    with pytest.raises(FrameError, match=r"a\.png: has no attitude"):
        make_view(frame(up_cam=None), 100)
