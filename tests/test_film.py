"""A film of a small flight, read back."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import make_sets
import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

cv2 = pytest.importorskip("cv2")

from horizon_dl.errors import InputError  # noqa: E402
from horizon_dl.frames.formats import open_recording  # noqa: E402
from horizon_dl.geometry.camera import Camera  # noqa: E402
from horizon_dl.geometry.horizon import elevation  # noqa: E402
from horizon_dl.geometry.rays import camera_rays  # noqa: E402
from horizon_dl.onboard.film import drawn_frames, frames_per_second, write_film  # noqa: E402


class FlatModel:
    threshold = 0.5

    def __init__(self, camera: Camera) -> None:
        self.camera = camera

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Any:
        assert up_cam is not None
        above = elevation(camera_rays(self.camera).directions, up_cam)
        return SimpleNamespace(p_above=np.where(above > 0, 0.9, 0.03).astype(np.float32), elevation=above)


def flight(tmp_path: Path, attitude: str = "-0.4") -> Path:
    rows = [f"{i}.png,{0.05 * i},0.0,{attitude if i else '-0.4'},0.0,1.5" for i in range(6)]
    return make_sets.images_csv(tmp_path / "flight", rows)


def test_a_film_has_the_flights_frames_and_rate(tmp_path: Path) -> None:
    recording = open_recording(flight(tmp_path))
    path = tmp_path / "film.mp4"
    try:
        written = write_film(path, FlatModel(recording.camera), recording)
    except InputError as error:
        pytest.skip(f"this OpenCV writes no MP4: {error}")
    assert written == 6
    film = cv2.VideoCapture(str(path))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 6
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(20.0, rel=0.01)
    assert (film.get(cv2.CAP_PROP_FRAME_WIDTH), film.get(cv2.CAP_PROP_FRAME_HEIGHT)) == (32, 24)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["film.mp4", "flight"]


def test_free_ground_is_drawn(tmp_path: Path) -> None:
    recording = open_recording(flight(tmp_path))
    picture = next(drawn_frames(FlatModel(recording.camera), recording)).astype(int)
    assert picture[20, 8, 1] > picture[20, 8, 2] + 5  # the grey picture, tinted green


def test_frames_without_attitude_are_left_out(tmp_path: Path) -> None:
    recording = open_recording(flight(tmp_path, attitude="nan"))
    assert len(list(drawn_frames(FlatModel(recording.camera), recording))) == 1


def test_a_folder_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    recording = open_recording(flight(tmp_path))
    with pytest.raises(InputError, match="cannot be written"):
        write_film(tmp_path / "none" / "film.mp4", FlatModel(recording.camera), recording)


def test_the_rate_is_the_median_and_bounded(tmp_path: Path) -> None:
    assert frames_per_second(open_recording(flight(tmp_path))) == pytest.approx(20.0)
    one = make_sets.images_csv(tmp_path / "one", ["a.png,0,0,0,0,1"])
    assert frames_per_second(open_recording(one)) == pytest.approx(10.0)
