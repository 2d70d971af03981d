"""A film of a small flight, read back."""

import shutil
from pathlib import Path
from typing import Any

import cv2
import make_sets
import pytest
from flat_model import FlatModel

from horizon_dl.cli import main
from horizon_dl.data.readers.registry import open_recording
from horizon_dl.errors import InputError
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.visualization.video import drawn_frames, frames_per_second, write_film

REFERENCE = Path(__file__).parents[1] / "exports" / "reference" / "model.onnx"


def flight(tmp_path: Path, attitude: str = "-0.4") -> Path:
    rows = [f"{i}.png,{0.05 * i},0.0,{attitude if i else '-0.4'},0.0,1.5" for i in range(6)]
    return make_sets.images_csv(tmp_path / "flight", rows)


def test_a_film_has_the_flights_frames_and_rate(tmp_path: Path) -> None:
    recording = open_recording(flight(tmp_path))
    path = tmp_path / "film.mp4"
    written = write_film(path, FlatModel(recording.camera), recording)
    assert written == 6
    film = cv2.VideoCapture(str(path))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 6
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(20.0, rel=0.01)
    assert (film.get(cv2.CAP_PROP_FRAME_WIDTH), film.get(cv2.CAP_PROP_FRAME_HEIGHT)) == (32, 24)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["film.mp4", "flight"]


def test_free_ground_is_drawn(tmp_path: Path) -> None:
    recording = open_recording(flight(tmp_path))
    model = FlatModel(recording.camera)
    model.place = None  # a flat grey picture would be no evidence of anything
    picture = next(drawn_frames(model, recording)).astype(int)
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


def part_of_the_embedded_flight(folder: Path, frames: int) -> Path:
    (folder / "images").mkdir(parents=True)
    shutil.copy(embedded_set() / "camera.yaml", folder)
    lines = (embedded_set() / "frames.csv").read_text().splitlines()[: frames + 1]
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    for line in lines[1:]:
        name = line.split(",")[0]
        shutil.copy(embedded_set() / name, folder / name)
    return folder


def test_the_verb_films_the_embedded_flight(tmp_path: Path, capsys: Any) -> None:
    data, path = part_of_the_embedded_flight(tmp_path / "set", 5), tmp_path / "out.mp4"
    arguments = ["predict", str(REFERENCE), str(data), "--out", str(tmp_path / "p"), "--video", str(path)]
    assert main(arguments) == 0
    film = cv2.VideoCapture(str(path))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 5
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(6.0, rel=0.01)
    assert (film.get(cv2.CAP_PROP_FRAME_WIDTH), film.get(cv2.CAP_PROP_FRAME_HEIGHT)) == (320, 240)
    assert "wrote 5 frames" in capsys.readouterr().out
    assert len(list((tmp_path / "p" / "panels").iterdir())) == 5


def test_a_film_needs_a_model_file_and_a_data_set(tmp_path: Path, capsys: Any) -> None:
    picture = next((embedded_set() / "images").iterdir())
    arguments = ["predict", str(REFERENCE), str(picture), "--out", str(tmp_path / "p"), "--video", "f.mp4"]
    assert main(arguments) == 2
    assert "needs an exported model and a camera" in capsys.readouterr().err
