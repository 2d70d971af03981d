"""Pictures in the encodings of ROS, and their cameras."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from make_bags import Maker, flight
from PIL import Image

from horizon_dl.errors import FrameError, InputError
from horizon_dl.logs.bags.pixels import bits_of, picture
from horizon_dl.readers.registry import open_recording

RGB = np.random.default_rng(3).integers(0, 256, (6, 8, 3)).astype(np.uint8)


def message(pixels: np.ndarray, encoding: str, big: bool = False, padding: int = 0) -> SimpleNamespace:
    rows = np.ascontiguousarray(pixels).reshape(len(pixels), -1).view(np.uint8)
    rows = np.pad(rows, [(0, 0), (0, padding)])
    return SimpleNamespace(
        height=pixels.shape[0],
        width=pixels.shape[1],
        encoding=encoding,
        is_bigendian=int(big),
        step=rows.shape[1],
        data=rows.ravel(),
    )


@pytest.mark.parametrize("padding", [0, 5])
def test_colours(padding: int) -> None:
    grey = RGB[..., 0]
    alpha = np.dstack([RGB, grey])
    for pixels, encoding, right in [
        (RGB, "rgb8", RGB),
        (RGB[..., ::-1], "bgr8", RGB),
        (alpha, "rgba8", RGB),
        (np.dstack([RGB[..., ::-1], grey]), "bgra8", RGB),
        (grey, "mono8", np.dstack([grey] * 3)),
    ]:
        np.testing.assert_array_equal(picture(message(pixels, encoding, padding=padding), ""), right)


@pytest.mark.parametrize("bits", [8, 10, 12, 16])
@pytest.mark.parametrize("big", [False, True])
def test_wide_pictures_use_the_bits_that_the_camera_has(bits: int, big: bool) -> None:
    grey = np.linspace(0, (1 << bits) - 1, 48).reshape(6, 8).astype(">u2" if big else "<u2")
    one = message(grey, "mono16", big)
    assert bits_of(one) == bits
    seen = picture(one, "", bits)
    assert (seen.min(), seen.max()) == (0, 255)


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
def test_bayer(pattern: str) -> None:
    """A picture of even colour comes back whole."""
    colour = {"r": 200, "g": 90, "b": 30}
    mosaic = np.array([[colour[pattern[(v % 2) * 2 + u % 2]] for u in range(8)] for v in range(6)], np.uint8)
    seen = picture(message(mosaic, f"bayer_{pattern}8"), "")
    np.testing.assert_array_equal(seen, np.broadcast_to([200, 90, 30], (6, 8, 3)))


@pytest.mark.parametrize("encoding", ["yuv422", "yuv422_yuy2"])
def test_yuv(encoding: str) -> None:
    even = np.full((6, 8, 3), [180, 60, 40], np.uint8)
    luma, blue, red = np.moveaxis(np.asarray(Image.fromarray(even).convert("YCbCr")), 2, 0)
    chroma = np.where(np.arange(8) % 2 == 0, blue, red)
    packed = np.dstack([chroma, luma] if encoding == "yuv422" else [luma, chroma]).astype(np.uint8)
    assert np.abs(picture(message(packed, encoding), "").astype(int) - even).max() <= 2


def test_what_cannot_be_shown_is_said() -> None:
    with pytest.raises(FrameError, match="the encoding '32FC1', which is not read"):
        picture(message(np.zeros((6, 8), np.float32), "32FC1"), "")
    short = message(RGB, "rgb8")
    short.data = short.data[:-30]
    with pytest.raises(FrameError, match="114 bytes for 8x6 pixels"):
        picture(short, "")
    with pytest.raises(FrameError, match="cannot be read as an image"):
        picture(SimpleNamespace(format="h264", data=np.zeros(9, np.uint8)), "")


def info_of(tmp_path: Path, topic: str = "/camera/image_raw", **values: Any) -> Any:
    pytest.importorskip("rosbags")
    maker = Maker()
    rows = [row for row in flight(maker)[0] if row[0] != "/camera/camera_info"]
    rows = [(topic if name == "/camera/image_raw" else name, t, m) for name, t, m in rows]
    rows.append(("/camera/camera_info", 0.0, maker.info(**values)))
    return open_recording(maker.write(tmp_path / "made", rows)).camera


def test_lenses_of_camera_info(tmp_path: Path) -> None:
    four = np.array([0.1, 0.01, 0.001, 0.0001])
    camera = info_of(tmp_path, distortion_model="equidistant", d=four)
    assert (camera.model, camera.distortion) == ("kannala_brandt", tuple(four))


def test_an_undistorted_picture_has_the_projection_s_lens(tmp_path: Path) -> None:
    new = np.array([20.0, 0, 14, 0, 0, 21, 10, 0, 0, 0, 1, 0])
    camera = info_of(tmp_path, "/camera/image_rect", d=np.array([0.1, 0, 0, 0, 0]), p=new)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (20, 21, 14, 10)
    assert not any(camera.distortion)


def test_binned_and_cut_out_pictures(tmp_path: Path) -> None:
    roi = Maker().new(
        "sensor_msgs/msg/RegionOfInterest", x_offset=10, y_offset=4, width=64, height=48, do_rectify=False
    )
    camera = info_of(tmp_path, size=(100, 80), roi=roi, binning_x=2, binning_y=2)
    # The middle of the sensor, 49.5 and 39.5, in pixels of two by two from 10 and 4 on.
    assert (camera.fx, camera.cx, camera.cy) == (15, 19.5, 17.5)


def test_a_camera_of_other_pictures_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"of pictures of 64x48 pixels, /camera/image_raw has 32x24"):
        info_of(tmp_path, size=(64, 48))


def test_a_camera_that_is_not_calibrated_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not calibrated; give --camera FILE"):
        info_of(tmp_path, k=np.zeros(9))
