"""What readers keep of the attitude's numbers, and lists and trajectories as other programs write them."""

import math
from collections.abc import Callable
from pathlib import Path

import make_sets
import numpy as np
import pytest
from make_bags import OPTICAL_IN_FLU, Maker
from test_reader_variants import kitti, trajectory
from test_ros_attitude import pictures, pose, ros_q

from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.readers.registry import open_recording
from horizon_dl.readers.tum_lists import read_list

HALF = 0.1


def as_tartanair(folder: Path) -> Path:
    rows = [f"1 2 -3 {math.sin(HALF)} 0 0 {math.cos(HALF)}", f"1 2 -3 0 {math.sin(HALF)} 0 {math.cos(HALF)}"]
    for index in range(2):
        make_sets.save_image(folder / "image_left" / f"{index:06d}_left.png", 64, 48)
    (folder / "pose_left.txt").write_text("\n".join(rows))
    return folder


def as_euroc(folder: Path) -> Path:
    path = make_sets.euroc(folder, truth=True) / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    poses = [f"{50_000_000 * i},0,0,1,{math.cos(0.01 * i)},0,{math.sin(0.01 * i)},0" for i in range(40)]
    path.write_text("\n".join(["#timestamp [ns],x,y,z,q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []", *poses]))
    return folder


def as_bag(folder: Path) -> Path:
    maker = Maker()
    rows, _ = pictures(maker)
    rows.append(("/tf_static", 0.0, maker.transform(0.0, "base_link", "cam", OPTICAL_IN_FLU)))
    rows += [("/pose", t, pose(maker, t, ros_q(t), "base_link")) for t in np.arange(0, 0.8, 0.02)]
    return maker.write(folder / "made", rows)


def as_tum(folder: Path) -> Path:
    return trajectory(folder / "freiburg3", [f"{i} 0 1 0.7 {0.1 * i} 0 -0.7" for i in range(4)])


MAKERS = [as_tartanair, as_euroc, as_bag, as_tum, kitti]


@pytest.mark.parametrize("make", MAKERS)
def test_the_numbers_that_are_kept_give_the_same_up(tmp_path: Path, make: Callable[[Path], Path]) -> None:
    recording = open_recording(make(tmp_path))
    reading = recording.reading
    assert reading is not None
    known = [header for header in recording.headers if header.up_cam is not None]
    assert len(known) > 1
    numbers = np.array([header.as_read for header in known])
    wanted = np.array([header.up_cam for header in known])
    np.testing.assert_allclose(reading.convention.ups_in_camera(numbers, reading.mount), wanted, atol=1e-7)
    again = recording.read_as("inverse")
    assert not np.allclose([h.up_cam for h in again.headers if h.up_cam is not None], wanted)


def rows_of(recording: Recording) -> list[tuple[str, float, list[float]]]:
    start_s = recording.headers[0].time_s
    ups = [[] if h.up_cam is None else np.round(h.up_cam, 6).tolist() for h in recording.headers]
    return [(h.name, round(h.time_s - start_s, 4), up) for h, up in zip(recording.headers, ups, strict=True)]


def dated(folder: Path) -> Path:
    """A TUM folder with Unix times, its lines in one form."""
    trajectory(folder / "freiburg3", [f"{i} 0 1 0.7 {0.1 * i} 0 -0.7" for i in range(4)])
    folder = folder / "freiburg3"
    for name in ("rgb.txt", "groundtruth.txt"):
        lines = [line.split() for line in (folder / name).read_text().splitlines()]
        (folder / name).write_text(
            "".join(f"{1.6e9 + 0.1 * int(t):.1f} {' '.join(rest)}\n" for t, *rest in lines)
        )
    return folder


def rewrite(path: Path, change: Callable[[list[str]], str], before: str = "") -> None:
    path.write_text(before + "".join(change(line.split()) + "\n" for line in path.read_text().splitlines()))


def in_unit(per_second: float) -> Callable[[list[str]], str]:
    return lambda cells: " ".join([str(round(float(cells[0]) * per_second)), *cells[1:]])


@pytest.mark.parametrize("per_second", [1e3, 1e6, 1e9])
@pytest.mark.parametrize("names", [("rgb.txt",), ("groundtruth.txt",), ("rgb.txt", "groundtruth.txt")])
def test_unix_times_of_tum_lists_in_any_unit(
    tmp_path: Path, per_second: float, names: tuple[str, ...]
) -> None:
    folder = dated(tmp_path)
    wanted = rows_of(open_recording(folder))
    for name in names:
        rewrite(folder / name, in_unit(per_second))
    assert rows_of(open_recording(folder)) == wanted


@pytest.mark.parametrize(
    ("before", "change"),
    [
        ("timestamp tx ty tz qx qy qz qw\n", " ".join),
        ("# timestamp tx ty tz qx qy qz qw\n", ",".join),
        ("# timestamp tx ty tz qw qx qy qz\n", lambda c: " ".join([*c[:4], c[7], *c[4:7]])),
        ("timestamp,tx,ty,tz,q_w,q_x,q_y,q_z\n", lambda c: ",".join([*c[:4], c[7], *c[4:7]])),
        ("", lambda c: ";".join(c).replace(".", ",")),
        ("", lambda c: "\t".join(c).replace(".", ",")),
        ("", lambda c: ", ".join(c)),
    ],
)
def test_trajectories_of_other_programs(
    tmp_path: Path, before: str, change: Callable[[list[str]], str]
) -> None:
    folder = dated(tmp_path)
    wanted = rows_of(open_recording(folder))
    rewrite(folder / "groundtruth.txt", change, before)
    assert rows_of(open_recording(folder)) == wanted


@pytest.mark.parametrize("head", ["", "rgb/", "./rgb/", "/a/set/rgb/", "../other/rgb/"])
def test_images_of_a_list_are_found_by_their_names(tmp_path: Path, head: str) -> None:
    folder = dated(tmp_path)
    wanted = rows_of(open_recording(folder))
    change = lambda cells: f"{cells[0]} {head}{Path(cells[1]).name}"  # noqa: E731
    rewrite(folder / "rgb.txt", change, "timestamp filename\n")
    assert len(read_list(folder / "rgb.txt")) == 4
    found = rows_of(open_recording(folder))
    assert [(time, up) for _, time, up in found] == [(time, up) for _, time, up in wanted]


@pytest.mark.parametrize("name", ["a" * 400 + ".png", "b/" * 1500 + "a.png", "a\0.png"])
def test_a_list_with_a_name_that_no_file_can_have_is_one_line(tmp_path: Path, name: str) -> None:
    folder = dated(tmp_path)
    rewrite(folder / "rgb.txt", lambda cells: f"{cells[0]} {name}", "timestamp filename\n")
    with pytest.raises(InputError):
        open_recording(folder)


def test_euroc_stamps_in_microseconds(tmp_path: Path) -> None:
    folder = as_euroc(tmp_path)
    wanted = rows_of(open_recording(folder))
    for path in folder.rglob("data.csv"):
        lines = path.read_text().splitlines()
        cells = [line.split(",", 1) for line in lines if not line.startswith("#")]
        moved = [f"{1_600_000_000_000_000 + int(t) // 1000},{rest}" for t, rest in cells]
        path.write_text("\n".join([*(line for line in lines if line.startswith("#")), *moved]))
    assert rows_of(open_recording(folder)) == wanted
