"""Reading one frame: modes, rotation, and everything that can be wrong with it."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.image_folder import FrameFiles, ImageLoader
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError
from horizon_dl.geometry.camera import Camera

UP = np.array([0.0, -1.0, 0.0])
COLOUR = np.random.default_rng(0).integers(0, 255, (6, 8, 3), dtype=np.uint8)


def recording(
    image: Path, truth: Path | None = None, turns: int = 0, size: tuple[int, int] = (8, 6)
) -> Recording:
    header = FrameHeader(image.name, 2.0, UP, height_m=1.1, labelled=truth is not None)
    load = ImageLoader((FrameFiles(image, truth),), turns)
    return Recording("set", "images_csv", Camera("pinhole", *size, 9.0, 9.0, 3.5, 2.5), (header,), load)


def save(path: Path, values: np.ndarray) -> Path:
    Image.fromarray(values).save(path)
    return path


def test_colour_image_is_read_as_it_is(tmp_path: Path) -> None:
    frame = recording(save(tmp_path / "a.png", COLOUR)).read(0)
    np.testing.assert_array_equal(frame.image, COLOUR)
    assert frame.image.flags.c_contiguous
    assert (frame.name, frame.time_s, frame.height_m, frame.truth) == ("a.png", 2.0, 1.1, None)


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_stored_image_is_turned_counter_clockwise(tmp_path: Path, turns: int) -> None:
    size = (8, 6) if turns % 2 == 0 else (6, 8)
    frame = recording(save(tmp_path / "a.png", COLOUR), turns=turns, size=size).read(0)
    np.testing.assert_array_equal(frame.image, np.rot90(COLOUR, turns))
    if turns == 1:  # the stored right edge becomes the top row
        np.testing.assert_array_equal(frame.image[0], COLOUR[:, -1])


def test_grey_sixteen_bit_alpha_and_palette(tmp_path: Path) -> None:
    grey = COLOUR[..., 0]
    deep = grey.astype(np.uint16) * 256 + 17
    alpha = np.dstack([COLOUR, np.full((6, 8), 255, dtype=np.uint8)])
    for name, values in (("grey", grey), ("deep", deep)):
        image = recording(save(tmp_path / f"{name}.png", values)).read(0).image
        np.testing.assert_array_equal(image, np.repeat(grey[..., None], 3, axis=-1))
    np.testing.assert_array_equal(recording(save(tmp_path / "r.png", alpha)).read(0).image, COLOUR)
    Image.fromarray(grey).convert("P").save(tmp_path / "p.png")
    assert recording(tmp_path / "p.png").read(0).image.shape == (6, 8, 3)


@pytest.mark.parametrize("suffix", ["png", "jpg"])
def test_truncated_image(tmp_path: Path, suffix: str) -> None:
    noise = np.random.default_rng(1).integers(0, 255, (60, 80, 3), dtype=np.uint8)
    path = save(tmp_path / f"a.{suffix}", noise)
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(FrameError, match=f"a.{suffix}: (is truncated|cannot be read)"):
        recording(path, size=(80, 60)).read(0)


@pytest.mark.parametrize("content", [b"", b"no image", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"])
def test_no_image_at_all(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(content)
    with pytest.raises(FrameError, match=r"a\.png: "):
        recording(path).read(0)


def test_missing_and_folder(tmp_path: Path) -> None:
    with pytest.raises(FrameError, match="is missing"):
        recording(tmp_path / "none.png").read(0)
    with pytest.raises(FrameError, match="is a folder"):
        recording(tmp_path).read(0)


def test_wrong_size(tmp_path: Path) -> None:
    with pytest.raises(FrameError, match="is 8x6 pixels when upright, the camera 6x8"):
        recording(save(tmp_path / "a.png", COLOUR), size=(6, 8)).read(0)


def test_truth(tmp_path: Path) -> None:
    image = save(tmp_path / "a.png", COLOUR)
    values = np.random.default_rng(2).integers(0, 4, (6, 8), dtype=np.uint8)
    truth = recording(image, save(tmp_path / "t.png", values)).read(0).truth
    assert truth is not None
    assert truth.dtype == np.uint8
    np.testing.assert_array_equal(truth, values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (COLOUR, "has 3 channels"),
        (np.zeros((5, 8), dtype=np.uint8), "is 8x5 pixels"),
        (np.full((6, 8), 7, dtype=np.uint8), "holds the value 7"),
    ],
)
def test_wrong_truth(tmp_path: Path, values: np.ndarray, message: str) -> None:
    image, truth = save(tmp_path / "a.png", COLOUR), save(tmp_path / "t.png", values)
    with pytest.raises(FrameError, match=message):
        recording(image, truth).read(0)


def test_truth_is_not_turned(tmp_path: Path) -> None:
    image = save(tmp_path / "a.png", COLOUR)
    values = np.zeros((8, 6), dtype=np.uint8)
    values[0, 0] = 3
    truth = recording(image, save(tmp_path / "t.png", values), turns=1, size=(6, 8)).read(0).truth
    assert truth is not None
    assert truth[0, 0] == 3
