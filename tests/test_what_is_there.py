"""Every door to a file: names that are none, and pipes, are one line, and are not waited for."""

import contextlib
import os
from collections.abc import Callable
from pathlib import Path

import make_sets
import numpy as np
import pytest
from fuzz import sets

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.calibration.picture_size import picture_size
from horizon_dl.config import load_config
from horizon_dl.data.images import load_rgb
from horizon_dl.data.orientation import orientation_of_file
from horizon_dl.data.photo_tags import dji_tags, exif_time_s
from horizon_dl.data.range_files import load_metres
from horizon_dl.errors import FrameError, InputError
from horizon_dl.logs.attitude_logs.registry import read_attitude
from horizon_dl.methods.open_predictor import open_predictor
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.training.run_folder import load_run

DOORS: dict[str, Callable[[Path], object]] = {
    "recording": open_recording,
    "attitude": lambda path: read_attitude(str(path)),
    "camera": read_calibration,
    "config": load_config,
    "image": load_rgb,
    "predictor": open_predictor,
    "model": ObstacleModel.load,
    "run": load_run,
}


@pytest.mark.parametrize("name", ["a" * 300, "a/" * 3000, "nothing", "a\0b", "file/below"])
@pytest.mark.parametrize("door", DOORS)
def test_a_name_that_leads_nowhere(tmp_path: Path, door: str, name: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError) as caught:
        DOORS[door](tmp_path / name)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("door", DOORS)
def test_a_pipe_is_not_waited_for(tmp_path: Path, door: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError):
        DOORS[door](tmp_path / "pipe")


@pytest.mark.parametrize(
    "make", [sets.kitti_odometry, sets.tartanair, sets.dji_photos, make_sets.kitti, make_sets.images_csv]
)
def test_a_sets_first_picture_is_a_pipe(tmp_path: Path, make: Callable[[Path], Path]) -> None:
    where = make(tmp_path / "set")
    picture = min(path for path in where.rglob("*") if path.suffix in (".png", ".JPG"))
    picture.unlink()
    os.mkfifo(picture)
    with contextlib.suppress(InputError):  # where the camera is told elsewhere, what is behind it is read
        assert open_recording(where).length


@pytest.mark.parametrize(
    "header",
    [
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }",
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (3, 10000000000), }",
        b"{'descr': '|O', 'fortran_order': False, 'shape': (3,), }",
        b"{'descr': '<c16', 'fortran_order': False, 'shape': (3,), }",
        b"{'descr': '<U9', 'fortran_order': False, 'shape': (3,), }",
        b"{" * 60,
        b"",
    ],
)
def test_an_array_that_promises_more_than_it_holds(tmp_path: Path, header: bytes) -> None:
    padded = header.ljust(117) + b"\n"
    (tmp_path / "a.npy").write_bytes(
        b"\x93NUMPY\x01\x00" + len(padded).to_bytes(2, "little") + padded + bytes(48)
    )
    with pytest.raises(FrameError, match="array of numbers"):
        load_metres(tmp_path / "a.npy", 1.0)


def test_an_array_is_read_and_a_pipe_is_not(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.array([[1.0, np.inf, -1.0]], np.float16))
    np.testing.assert_array_equal(load_metres(tmp_path / "a.npy", 1.0), [[1.0, np.nan, np.nan]])
    os.mkfifo(tmp_path / "pipe.npy")
    with pytest.raises(FrameError):
        load_metres(tmp_path / "pipe.npy", 1.0)


def test_what_is_asked_of_a_picture_is_not_asked_of_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.jpg")
    path = tmp_path / "a.jpg"
    assert (picture_size([path]), orientation_of_file(path), dji_tags(path), exif_time_s(path)) == (
        None,
        1,
        {},
        None,
    )
