"""A film of a small flight, read back, and what `predict` leaves from every kind of source."""

import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene import plain, scene

from horizon_dl.cli import main
from horizon_dl.errors import InputError
from horizon_dl.runtime.ranged import ranges_of
from horizon_dl.simulation.embedded import embedded_set
from horizon_dl.visualization.film import LONGEST_S, Film
from horizon_dl.visualization.film_picture import FilmPicture

av = pytest.importorskip("av")
REFERENCE = Path(__file__).parents[1] / "exports" / "reference" / "model.onnx"


def played(path: Path) -> tuple[str, list[float], tuple[int, int]]:
    """Codec, times and size."""
    with av.open(str(path)) as film:
        stream = film.streams.video[0]
        times: list[float] = []
        with suppress(av.error.InvalidDataError):  # the end of a film that was cut off
            times += (float(picture.time) for picture in film.decode(stream))
        return stream.codec_context.name, times, (stream.width, stream.height)


def write(path: Path, times: list[float]) -> None:
    film = Film(path)
    for index, time_s in enumerate(times):
        frame, prediction = scene(index, time_s)
        film.log(frame, prediction, ranges_of(frame, prediction))
    film.close()


def test_a_film_plays_in_browsers_at_the_frames_own_pace(tmp_path: Path) -> None:
    write(tmp_path / "film.mp4", [5.0, 5.1, 5.3, 9.0, 8.0, float("nan")])
    codec, times, size = played(tmp_path / "film.mp4")
    assert codec == "h264"
    gaps = np.diff(times)
    np.testing.assert_allclose(gaps[:3], [0.1, 0.2, LONGEST_S], atol=0.002)
    assert (gaps > 0).all()  # a clock that runs backwards, or is lost, does not stop the film
    assert size[0] % 2 == size[1] % 2 == 0


@pytest.mark.parametrize("rate_hz", [8, 10, 15, 30, 120])
def test_a_film_shows_ten_pictures_a_second_at_most_and_lasts_as_long(tmp_path: Path, rate_hz: int) -> None:
    write(tmp_path / "film.mp4", [2.0 + index / rate_hz for index in range(3 * rate_hz)])
    _, times, _ = played(tmp_path / "film.mp4")
    assert len(times) == pytest.approx(3 * min(rate_hz, 10), abs=1)
    assert times[-1] == pytest.approx(3.0, abs=0.15)


def test_a_recording_begun_anew_goes_on_in_the_film(tmp_path: Path) -> None:
    write(tmp_path / "film.mp4", [0.0, 0.1, 0.2, 0.3, 0.0, 0.1, 0.2, 0.3])
    assert len(played(tmp_path / "film.mp4")[1]) == 8


def test_what_a_killed_process_leaves_still_plays(tmp_path: Path) -> None:
    film = Film(tmp_path / "film.mp4")
    for index in range(90):
        film.log(*scene(index), None)
    cut = tmp_path / "cut.mp4"
    shutil.copy(tmp_path / "film.mp4", cut)  # as it lies there, never closed
    film.close()
    assert len(played(cut)[1]) >= 25


def test_every_picture_has_the_same_size_and_says_what_is_missing() -> None:
    picture, (frame, prediction) = FilmPicture(with_ground=True), scene()
    with_ranges = picture(frame, prediction, ranges_of(frame, prediction))
    assert picture(plain(frame), prediction, None).shape == with_ranges.shape
    assert FilmPicture(with_ground=False)(frame, prediction, None).shape[1] < with_ranges.shape[1]


def test_a_folder_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    film, (frame, prediction) = Film(tmp_path / "none" / "film.mp4"), scene()
    with pytest.raises(InputError, match="cannot be written as a film"):
        film.log(frame, prediction, None)


def part_of_the_embedded_flight(folder: Path, frames: int) -> Path:
    (folder / "images").mkdir(parents=True)
    shutil.copy(embedded_set() / "camera.yaml", folder)
    lines = (embedded_set() / "frames.csv").read_text().splitlines()[: frames + 1]
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    for line in lines[1:]:
        name = line.split(",")[0]
        shutil.copy(embedded_set() / name, folder / name)
    return folder


def test_predict_leaves_a_film_and_a_page(tmp_path: Path, capsys: Any) -> None:
    data, copy = part_of_the_embedded_flight(tmp_path / "set", 5), tmp_path / "copy.mp4"
    out = tmp_path / "p"
    arguments = ["predict", str(REFERENCE), str(data), "--out", str(out), "--video", str(copy)]
    assert main(arguments) == 0
    assert "wrote 5 frames" in capsys.readouterr().out
    codec, times, _ = played(out / "film.mp4")
    assert (codec, len(times)) == ("h264", 5)
    assert copy.read_bytes() == (out / "film.mp4").read_bytes()
    page = (out / "index.html").read_text()
    assert "film.mp4" in page
    assert len(list((out / "panels").iterdir())) == len(list((out / "arrays").iterdir())) == 5


def test_plain_pictures_make_a_page_and_one_picture_no_film(tmp_path: Path) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    for name in ("00001.jpg", "00002.jpg"):
        shutil.copy(embedded_set() / "images" / name, folder)
    assert main(["predict", str(REFERENCE), str(folder), "--out", str(tmp_path / "two")]) == 0
    assert len(played(tmp_path / "two" / "film.mp4")[1]) == 2
    one = folder / "00001.jpg"
    assert main(["predict", str(REFERENCE), str(one), "--out", str(tmp_path / "one")]) == 0
    assert not (tmp_path / "one" / "film.mp4").exists()
    assert (tmp_path / "one" / "index.html").is_file()


def test_panels_of_every_nth_frame_and_a_film_beside_them(tmp_path: Path, capsys: Any) -> None:
    data, out = part_of_the_embedded_flight(tmp_path / "set", 5), tmp_path / "p"
    assert main(["predict", str(REFERENCE), str(data), "--out", str(out), "--every", "2"]) == 0
    assert "panels and arrays of 1 in 2 frames" in capsys.readouterr().out
    assert len(played(out / "film.mp4")[1]) == 5
    for folder in ("panels", "arrays"):
        assert sorted(one.stem for one in (out / folder).rglob("*.*")) == ["00000", "00002", "00004"]
