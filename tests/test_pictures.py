"""Pictures as viewers show them: EXIF orientation, and more than 8 bits."""

import struct
import zlib
from pathlib import Path

import make_sets
import numpy as np
import pytest
from PIL import Image

from horizon_dl.data.bit_depth import used_bits
from horizon_dl.data.images import load_rgb
from horizon_dl.data.orientation import TAG, upright
from horizon_dl.readers.registry import open_recording

# Blocks of 8 pixels, so that JPEG keeps them apart.
BLOCKS = np.random.default_rng(0).permutation(np.arange(12) * 20).reshape(3, 4).astype(np.uint8)
UPRIGHT = np.repeat(np.kron(BLOCKS, np.ones((8, 8), np.uint8))[..., None], 3, axis=-1)
# How the stored image comes from the upright one: what Pillow's own transposition undoes.
INVERSE = {1: 1, 2: 2, 3: 3, 4: 4, 5: 5, 6: 8, 7: 7, 8: 6}


def stored(orientation: int, picture: np.ndarray = UPRIGHT) -> np.ndarray:
    return upright(picture, INVERSE[orientation])


def save(path: Path, picture: np.ndarray, orientation: int | None = None) -> Path:
    exif = Image.Exif()
    if orientation is not None:
        exif[TAG] = orientation
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(path, exif=exif)
    return path


def save_png16(path: Path, values: np.ndarray, significant: int | None = None) -> Path:
    """A PNG of 16 bits a channel, grey or RGB, which Pillow cannot write."""
    height, width = values.shape[:2]

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    channels = 1 if values.ndim == 2 else 3
    header = struct.pack(">IIBBBBB", width, height, 16, 0 if channels == 1 else 2, 0, 0, 0)
    bits = b"" if significant is None else chunk(b"sBIT", bytes([significant] * channels))
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in values)
    content = chunk(b"IHDR", header) + bits + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + content)
    return path


@pytest.mark.parametrize("suffix", ["jpg", "png", "tif", "webp"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation(tmp_path: Path, suffix: str, orientation: int) -> None:
    path = save(tmp_path / f"a.{suffix}", stored(orientation), orientation)
    image = load_rgb(path)
    assert image.shape == UPRIGHT.shape
    assert image.flags.c_contiguous
    assert np.abs(image.astype(int) - UPRIGHT).max() < 12
    with Image.open(path) as opened:
        from PIL import ImageOps

        np.testing.assert_array_equal(image, np.asarray(ImageOps.exif_transpose(opened).convert("RGB")))


@pytest.mark.parametrize("orientation", [None, 0, 9, 77])
def test_no_orientation_that_makes_sense(tmp_path: Path, orientation: int | None) -> None:
    np.testing.assert_array_equal(load_rgb(save(tmp_path / "a.png", UPRIGHT, orientation)), UPRIGHT)


def test_damaged_exif_does_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "a.jpg"
    Image.fromarray(UPRIGHT).save(path, exif=b"Exif\0\0MM\0*\0\0\0\x08\xff\xff" + b"\xff" * 20)
    assert load_rgb(path).shape == UPRIGHT.shape


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("turn", ["none", "180", "90ccw"])
def test_truth_ranges_and_rotate_image(tmp_path: Path, orientation: int, turn: str) -> None:
    """`rotate_image` turns what a viewer shows; labels are upright then, ranges lie as the file stores."""
    turns = {"none": 0, "180": 2, "90ccw": 1}[turn]
    shown = np.rot90(UPRIGHT, -turns)
    size = f"width: {UPRIGHT.shape[1]}\nheight: {UPRIGHT.shape[0]}"
    camera = make_sets.CAMERA_YAML.replace("width: 32\nheight: 24", size) + f"rotate_image: {turn}\n"
    folder = make_sets.images_csv(tmp_path, ["a.png,0,0,0,0,1"], camera=camera)
    save(folder / "a.png", stored(orientation, np.ascontiguousarray(shown)), orientation)
    labels = (UPRIGHT[..., 0] % 4).astype(np.uint8)
    save(folder / "labels" / "a.png", labels)
    counts = UPRIGHT[..., 0].astype(np.uint16) * 10 + 1
    as_stored = stored(orientation, np.ascontiguousarray(np.rot90(counts, -turns)))
    save_png16(folder / "depth" / "a.png", as_stored)
    frame = open_recording(folder).read(0)
    np.testing.assert_array_equal(frame.image, UPRIGHT)
    np.testing.assert_array_equal(frame.truth, labels)
    assert frame.ranges is not None
    np.testing.assert_allclose(frame.ranges.metres, counts / 1000)


def deep_set(folder: Path, pictures: list[np.ndarray], significant: int | None = None) -> Path:
    height, width = pictures[0].shape[:2]
    size = f"width: {width}\nheight: {height}"
    camera = make_sets.CAMERA_YAML.replace("width: 32\nheight: 24", size)
    rows = [f"{i}.png,{i / 10},0,0,0,1" for i in range(len(pictures))]
    make_sets.images_csv(folder, rows, camera=camera)
    for index, picture in enumerate(pictures):
        save_png16(folder / f"{index}.png", picture, significant)
    return folder


@pytest.mark.parametrize("bits", [8, 10, 12, 14])
@pytest.mark.parametrize("colour", [False, True])
def test_deep_pictures_use_the_whole_scale(tmp_path: Path, bits: int, colour: bool) -> None:
    picture = UPRIGHT if colour else UPRIGHT[..., 0]
    values = picture.astype(np.uint16) << (bits - 8)
    recording = open_recording(deep_set(tmp_path, [values, values // 2]))
    np.testing.assert_array_equal(recording.read(0).image, UPRIGHT)
    # One scale for all pictures: the darker one stays darker.
    assert np.abs(recording.read(1).image.astype(int) - UPRIGHT // 2).max() <= 1
    assert f"use {bits} of their 16 bits" in recording.notes[0]


def test_sixteen_bits_stay_sixteen(tmp_path: Path) -> None:
    values = UPRIGHT[..., 0].astype(np.uint16) << 8
    recording = open_recording(deep_set(tmp_path, [values // 300, values]))
    assert recording.notes == ()
    np.testing.assert_array_equal(recording.read(1).image, UPRIGHT)
    assert recording.read(0).image.max() == 0


def test_a_file_that_tells_its_bits_is_believed(tmp_path: Path) -> None:
    dark = UPRIGHT[..., 0].astype(np.uint16)
    recording = open_recording(deep_set(tmp_path, [dark], significant=12))
    assert "use 12 of" in recording.notes[0]
    np.testing.assert_array_equal(recording.read(0).image[..., 0], dark >> 4)


@pytest.mark.parametrize("largest", [1023, 4095, 65535])
def test_pgm_is_scaled_by_its_own_largest_value(tmp_path: Path, largest: int) -> None:
    values = np.linspace(0, largest, 12).astype(">u2").reshape(3, 4)
    path = tmp_path / "a.pgm"
    path.write_bytes(f"P5 4 3 {largest}\n".encode() + values.tobytes())
    image = load_rgb(path, bits=used_bits([path]))
    np.testing.assert_allclose(image[..., 0], values / largest * 255, atol=1.1)


@pytest.mark.parametrize("before", ["P5\n", "P5\n# made by a logger\n", "P5 "])
def test_pgm_that_states_all_bits_and_uses_fewer(tmp_path: Path, before: str) -> None:
    height, width = UPRIGHT.shape[:2]
    size = f"width: {width}\nheight: {height}"
    camera = make_sets.CAMERA_YAML.replace("width: 32\nheight: 24", size)
    folder = make_sets.images_csv(tmp_path, ["a.pgm,0,0,0,0,1"], camera=camera)
    values = UPRIGHT[..., 0].astype(">u2") << 4
    (folder / "a.pgm").write_bytes(
        f"{before}{width} {height}\n65535\n".encode() + values.astype(">u2").tobytes()
    )
    recording = open_recording(folder)
    assert "use 12 of their 16 bits" in recording.notes[0]
    np.testing.assert_array_equal(recording.read(0).image[..., 0], UPRIGHT[..., 0])


def test_deep_pictures_are_turned_too(tmp_path: Path) -> None:
    values = UPRIGHT[..., 0].astype(np.uint16) << 4
    path = tmp_path / "a.tif"
    exif = Image.Exif()
    exif[TAG] = 6
    Image.fromarray(stored(6, values)).save(path, exif=exif)
    np.testing.assert_array_equal(load_rgb(path, bits=used_bits([path])), UPRIGHT)


def test_brighter_pixels_than_seen_are_clipped(tmp_path: Path) -> None:
    path = save_png16(tmp_path / "a.png", np.array([[0, 4095, 4096, 60000]], np.uint16))
    assert load_rgb(path, bits=12)[0, :, 0].tolist() == [0, 255, 255, 255]
