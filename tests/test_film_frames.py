"""Films: every frame at any place, at its own time, upright; damaged ones end in words."""

import pickle
import struct
from contextlib import suppress
from pathlib import Path

import make_films
import numpy as np
import pytest

from horizon_dl.data.containers import first_frame
from horizon_dl.data.film_frames import FilmLoader, time_stamps
from horizon_dl.data.given import Given
from horizon_dl.errors import FrameError, InputError
from horizon_dl.sources.open_source import open_source

UNEVEN = [0, 33, 66, 100, 250, 260, 400, 433, 466, 500, *range(600, 2600, 40)]
PLAIN = Given(needs_attitude=False)


@pytest.mark.parametrize("name", ["a.mp4", "a.mkv", "a.mov"])
def test_times_are_the_containers_own_at_a_variable_rate(tmp_path: Path, name: str) -> None:
    recording = open_source(make_films.film(tmp_path / name, UNEVEN), None, PLAIN)
    assert recording.length == len(UNEVEN)
    times = [header.time_s for header in recording.headers]
    assert times == pytest.approx([stamp / 1000 for stamp in UNEVEN], abs=1e-3)


@pytest.mark.parametrize("gop", ["0", "1"])
@pytest.mark.parametrize("name", ["a.mp4", "a.mkv", "a.ts"])
def test_any_frame_is_found_in_any_order(tmp_path: Path, name: str, gop: str) -> None:
    path = make_films.film(tmp_path / name, UNEVEN, options={"x264-params": f"open-gop={gop}"})
    recording = open_source(path, None, PLAIN)
    order = [*range(5), 40, 41, 3, 59, 0, 13, 11, 12, 58, 25, 24, 23, *range(30, 60)]
    assert [make_films.number_of(recording.read(index).image) for index in order] == order


@pytest.mark.parametrize(("name", "codec"), [("a.avi", "mpeg4"), ("a.avi", "mjpeg"), ("a.webm", "libvpx")])
def test_other_containers_are_read(tmp_path: Path, name: str, codec: str) -> None:
    path = make_films.film(tmp_path / name, range(0, 1200, 40), codec)
    recording = open_source(path, None, PLAIN)
    assert recording.length == 30
    assert [make_films.number_of(recording.read(index).image) for index in (0, 1, 2, 29, 7)] == [
        0,
        1,
        2,
        29,
        7,
    ]


def test_a_film_that_is_stored_turned_is_shown_upright(tmp_path: Path) -> None:
    path = make_films.film(tmp_path / "a.mp4", range(0, 400, 40))
    data = path.read_bytes()
    at = data.index(b"tkhd") + 4 + 40  # the matrix of the track's header, version 0
    quarter = struct.pack(">9i", 0, 1 << 16, 0, -(1 << 16), 0, 0, 0, 0, 1 << 30)  # a quarter turn clockwise
    (tmp_path / "turned.mp4").write_bytes(data[:at] + quarter + data[at + 36 :])
    image = open_source(tmp_path / "turned.mp4", None, PLAIN).read(5).image
    assert image.shape == (64, 48, 3)
    assert make_films.number_of(np.rot90(image)) == 5


def test_a_loader_travels_between_processes(tmp_path: Path) -> None:
    recording = open_source(make_films.film(tmp_path / "a.mp4", UNEVEN), None, PLAIN)
    recording.read(7)
    again = pickle.loads(pickle.dumps(recording))
    assert make_films.number_of(again.read(31).image) == 31


def test_a_film_that_is_cut_off_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = make_films.film(tmp_path / "a.mkv", range(0, 4000, 40))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) * 2 // 3])
    recording = open_source(path, None, PLAIN)
    assert 30 < recording.length < 100
    frames = list(recording.frames())
    good = [frame for frame in frames if not isinstance(frame, FrameError)]
    assert len(good) > 30
    assert [make_films.number_of(one.image) for one in good[:20]] == list(range(20))


@pytest.mark.parametrize("seed", range(20))
def test_the_first_frame_of_a_damaged_film_is_a_later_one_or_is_said_to_be_none(
    tmp_path: Path, seed: int
) -> None:
    data = bytearray(make_films.film(tmp_path / "a.mp4", range(0, 1200, 40)).read_bytes())
    begin = data.index(b"mdat") + 4
    rng = np.random.default_rng(seed)
    for place in rng.integers(begin, min(begin + 3000, len(data)), 5 + 20 * seed):
        data[place] = rng.integers(256)
    (tmp_path / "damaged.mp4").write_bytes(data)
    with suppress(InputError):
        frame = first_frame(tmp_path / "damaged.mp4")
        assert (frame.width, frame.height) == (64, 48)


def test_damage_inside_costs_frames_and_no_others(tmp_path: Path) -> None:
    path = make_films.film(tmp_path / "a.mp4", range(0, 4000, 40))
    data = bytearray(path.read_bytes())
    start = data.index(b"mdat")
    middle = (start + data.index(b"moov")) // 2
    data[middle : middle + 200] = b"\xff" * 200
    path.write_bytes(data)
    frames = list(open_source(path, None, PLAIN).frames())
    good = [frame for frame in frames if not isinstance(frame, FrameError)]
    assert len(frames) == 100
    assert len(good) > 50
    for frame in [*good[:20], *good[-20:]]:
        assert make_films.number_of(frame.image) == int(frame.name)


@pytest.mark.parametrize("data", [b"", b"not a film at all" * 100, b"\0\0\0\x20ftypisom" + b"\0" * 500])
def test_what_is_no_film_is_said_in_one_line(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.mp4").write_bytes(data)
    with pytest.raises(InputError, match="no film"):
        open_source(tmp_path / "a.mp4", None, PLAIN)


def test_a_film_without_its_index_was_cut_off(tmp_path: Path) -> None:
    path = make_films.film(tmp_path / "a.mp4", range(0, 4000, 40))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InputError, match="cut off before its index was written"):
        open_source(path, None, PLAIN)


def test_two_films_in_a_folder_are_named(tmp_path: Path) -> None:
    for name in ("a.mp4", "b.MOV"):
        make_films.film(tmp_path / name, range(0, 400, 40))
    with pytest.raises(InputError, match=r"holds 2 films: a\.mp4, b\.MOV; give one of them"):
        open_source(tmp_path, None, PLAIN)


def test_a_frame_that_is_not_there_is_an_error_of_its_own(tmp_path: Path) -> None:
    path = make_films.film(tmp_path / "a.mp4", range(0, 400, 40))
    stamps, _ = time_stamps(path)
    loader = FilmLoader(path, (stamps[0], stamps[0] + 1, *stamps[1:]))
    assert make_films.number_of(loader(0, False).image) == 0
    with pytest.raises(FrameError, match="frame 1 cannot be decoded"):
        loader(1, False)
    assert make_films.number_of(loader(2, False).image) == 1
    path.unlink()
    with pytest.raises(FrameError):
        FilmLoader(path, tuple(stamps))(0, False)
