"""Pictures of any size at a model's size."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from horizon_dl.runtime.fit_picture import fit_picture

sides = st.integers(1, 80)


@given(sides, sides, sides, sides)
def test_all_of_the_picture_lies_in_the_middle_and_nothing_else(width, height, to_width, to_height):
    fitted = fit_picture(np.full((height, width, 3), 7, np.uint8), to_width, to_height)
    assert fitted.image.shape == (to_height, to_width, 3)
    assert (fitted.image == 7).all()  # borders repeat the picture, they are not black
    (top, bottom), (left, right) = fitted.rows, fitted.columns
    assert 0 <= top < bottom <= to_height
    assert 0 <= left < right <= to_width
    assert abs(top - (to_height - bottom)) <= 1
    assert abs(left - (to_width - right)) <= 1
    assert bottom - top == to_height or right - left == to_width
    assert fitted.part(fitted.image).shape == (bottom - top, right - left, 3)
    assert min(fitted.part(np.zeros((3, 5))).shape) >= 1


def test_it_is_scaled_as_pillow_does():
    image = np.random.default_rng(0).integers(0, 255, (90, 120, 3), np.uint8)
    small = fit_picture(image, 40, 60)
    assert (small.rows, small.columns) == ((15, 45), (0, 40))
    boxes = np.asarray(Image.fromarray(image).resize((40, 30), Image.Resampling.BOX)).astype(int)
    assert abs(small.part(small.image).astype(int) - boxes).max() <= 1
    assert (small.image[:15] == small.image[15]).all()


def test_an_aspect_that_is_hardly_another_fills_the_whole():
    assert fit_picture(np.zeros((480, 642, 3), np.uint8), 320, 240).rows == (0, 240)
    assert fit_picture(np.zeros((480, 640, 3), np.uint8), 320, 240).columns == (0, 320)
