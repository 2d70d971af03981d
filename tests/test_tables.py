"""Tables as people have them: separators, decimals, encodings, names of columns, units."""

import math
from pathlib import Path

import make_sets
import numpy as np
import pytest
from hypothesis import given as for_all
from hypothesis import settings
from hypothesis import strategies as st

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.tables.columns import KEYS, match
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.iso_time import seconds_of_dates
from horizon_dl.data.tables.table import number, read_table
from horizon_dl.data.tables.units import CAMERA_STEPS, LOG_STEPS, DoubtError, Steps, angle_unit, clock_unit
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.csv_table import read as read_attitude_csv
from horizon_dl.readers.registry import open_recording

OWN = ("image", "time_s", "roll_rad", "pitch_rad", "yaw_rad", "height_m")
TURNS = [(0.1, 0.05, 1.0), (-0.2, 0.1, -2.0), (0.0, -0.15, 3.0)]


def write_set(
    folder: Path,
    header: tuple[str, ...] = OWN,
    *,
    separator: str = ",",
    decimal: str = ".",
    encoding: str = "utf-8",
    end: str = "\n",
    time_scale: float = 1.0,
    start: float = 5.0,
    angle_scale: float = 1.0,
    name: str = "frames.csv",
    before: str = "",
) -> Path:
    """Three frames, 0.1 s apart, with the attitudes TURNS and a height of 1.5 m."""
    lines = [separator.join(header)]
    for index, turn in enumerate(TURNS):
        make_sets.save_image(folder / "images" / f"{index}.png")
        seconds = round(time_scale * (start + 0.1 * index), 6)
        numbers = [int(seconds) if seconds == int(seconds) else seconds]
        numbers += [repr(angle_scale * angle) for angle in turn]
        cells = [str(one).replace(".", decimal) for one in (*numbers, 1.5)]
        lines.append(separator.join([f"images/{index}.png", *cells]))
    (folder / name).write_bytes((before + end.join(lines) + end).encode(encoding))
    (folder / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    return folder


def same(found: FrameHeader, wanted: FrameHeader, start: float = 5.0) -> None:
    np.testing.assert_allclose(found.up_cam, wanted.up_cam, atol=1e-9)
    assert found.yaw_rad == pytest.approx(wanted.yaw_rad)
    assert found.height_m == pytest.approx(1.5)
    assert found.time_s - start == pytest.approx(wanted.time_s - 5.0, abs=1e-4)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> list[FrameHeader]:
    return list(open_recording(write_set(tmp_path_factory.mktemp("plain"))).headers)


def check_same(folder: Path, plain: list[FrameHeader], start: float = 5.0, given: Given = Given()) -> None:  # noqa: B008
    recording = open_recording(folder, given=given)
    assert recording.format == "images_csv"
    assert recording.length == 3
    for found, wanted in zip(recording.headers, plain, strict=True):
        same(found, wanted, start)


DIALECTS = [(s, d) for s in (",", ";", "\t", "|", " ", ", ", "; ") for d in ".," if s.strip() != d]


@pytest.mark.parametrize(("separator", "decimal"), DIALECTS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"])
def test_separators_decimals_and_encodings(
    tmp_path: Path, plain: list[FrameHeader], separator: str, decimal: str, encoding: str
) -> None:
    folder = write_set(tmp_path, separator=separator, decimal=decimal, encoding=encoding, end="\r\n")
    check_same(folder, plain)


@pytest.mark.parametrize("before", ["sep=;\n", "# made by a logger\n", "% one\n# two, of; three\n\n"])
def test_lines_before_the_header(tmp_path: Path, plain: list[FrameHeader], before: str) -> None:
    check_same(write_set(tmp_path, separator=";", decimal=",", before=before), plain)


@pytest.mark.parametrize("sign", ["#", "# ", "%"])
def test_header_that_is_a_comment(tmp_path: Path, plain: list[FrameHeader], sign: str) -> None:
    check_same(write_set(tmp_path, (f"{sign}image", *OWN[1:])), plain)


HEADERS = [
    ("Image", "Time_S", "Roll_Rad", "Pitch_Rad", "Yaw_Rad", "Height_M"),
    ("IMAGE", "TIME (S)", "ROLL [RAD]", "PITCH [RAD]", "YAW [RAD]", "HEIGHT [M]"),
    ("filename", "timestamp", "phi_rad", "theta_rad", "psi_rad", "height"),
    ("File Name", "seconds", "Roll (radians)", "Pitch (radians)", "Heading (radians)", "AGL (m)"),
    ("ImageFile", "t", "rollRad", "pitchRad", "yawRad", "heightM"),
    ("img_path", "elapsed_s", "att_roll_rad", "att_pitch_rad", "att_yaw_rad", "height_agl_m"),
]


@pytest.mark.parametrize("header", HEADERS)
def test_names_of_columns(tmp_path: Path, plain: list[FrameHeader], header: tuple[str, ...]) -> None:
    check_same(write_set(tmp_path, header), plain)


@pytest.mark.parametrize(
    ("named", "scale"),
    [("ms", 1e3), ("us", 1e6), ("ns", 1e9), ("µs", 1e6), ("usec", 1e6), ("milliseconds", 1e3)],
)
@pytest.mark.parametrize("start", [0.0, 5.0, 1.6e9])
def test_unit_of_the_time_in_its_name(
    tmp_path: Path, plain: list[FrameHeader], named: str, scale: float, start: float
) -> None:
    header = ("image", f"time [{named}]", *OWN[2:])
    check_same(write_set(tmp_path, header, time_scale=scale, start=start), plain, start)


@pytest.mark.parametrize("scale", [1.0, 1e3, 1e6, 1e9])
@pytest.mark.parametrize("name", ["timestamp", "time", "time_s"])
def test_unix_time_is_certain(tmp_path: Path, plain: list[FrameHeader], name: str, scale: float) -> None:
    folder = write_set(tmp_path, ("image", name, *OWN[2:]), time_scale=scale, start=1.6e9)
    check_same(folder, plain, 1.6e9)
    notes = open_recording(folder).notes
    assert bool(notes) == (scale != 1.0)


def test_a_clock_that_is_not_as_named_is_named(tmp_path: Path, plain: list[FrameHeader]) -> None:
    folder = write_set(tmp_path, time_scale=1e3)
    with pytest.raises(InputError) as caught:
        open_recording(folder)
    text = str(caught.value)
    assert "columns found: image, time_s, roll_rad" in text
    assert "time looks like milliseconds" in text
    assert "--time-unit ms" in text
    check_same(folder, plain, given=Given(time_unit="ms"))
    slow = open_recording(folder, given=Given(time_unit="s"))
    assert slow.headers[-1].time_s == pytest.approx(5200.0)


@pytest.mark.parametrize("unit", ["deg", "degrees", "°"])
def test_degrees_in_the_name(tmp_path: Path, plain: list[FrameHeader], unit: str) -> None:
    header = ("image", "time_s", f"roll [{unit}]", f"pitch [{unit}]", f"yaw [{unit}]", "height_m")
    check_same(write_set(tmp_path, header, angle_scale=180 / math.pi), plain)


@pytest.mark.parametrize("header", [OWN, ("image", "time", "Roll", "Pitch", "Yaw", "height")])
def test_angles_over_a_turn_are_degrees(
    tmp_path: Path, plain: list[FrameHeader], header: tuple[str, ...]
) -> None:
    check_same(write_set(tmp_path, header, angle_scale=180 / math.pi), plain)


def test_small_angles_without_a_unit_are_named(tmp_path: Path, plain: list[FrameHeader]) -> None:
    folder = write_set(tmp_path, ("image", "time", "roll", "pitch", "yaw", "height"))
    with pytest.raises(InputError, match=r"columns found: image, time, roll.*--angle-unit rad or"):
        open_recording(folder)
    check_same(folder, plain, given=Given(angle_unit="rad"))


def test_quaternion_columns(tmp_path: Path) -> None:
    half = math.sqrt(0.5)
    rows = [f"images/{i}.png,{i / 10},0,{half},0,{half}" for i in range(2)]
    folder = make_sets.images_csv(tmp_path, rows, "image,time_s,q_x,q_y,q_z,q_w")
    up = open_recording(folder).headers[0].up_cam  # nose straight up
    np.testing.assert_allclose(up, [0.0, 0.0, 1.0], atol=1e-9)


def test_dates(tmp_path: Path) -> None:
    rows = [f"a{i}.png,2024-05-01 12:30:0{i}.250,0,0" for i in range(2)]
    folder = make_sets.images_csv(tmp_path, rows, "image,timestamp,roll_rad,pitch_rad")
    first, second = open_recording(folder).headers
    assert second.time_s - first.time_s == pytest.approx(1.0)
    assert seconds_of_dates(["1.5", "2.5"]) is None
    assert seconds_of_dates(["", "1970-01-01T00:00:01+00:00"])[1] == 1.0  # type: ignore[index]


def test_decimal_commas_between_commas_are_named(tmp_path: Path) -> None:
    folder = write_set(tmp_path, separator=",", decimal=",")
    with pytest.raises(InputError, match="decimal commas with semicolons"):
        open_recording(folder)


def test_numbers_without_names_are_named(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("0.0,0.1,0.2\n0.1,0.1,0.2\n")
    with pytest.raises(InputError, match="no line that names its columns"):
        read_attitude_csv(path)


def test_missing_columns_name_what_is_there(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time_s;pitch_rad;gyro_x\n0;0;0\n0.1;0;0\n")
    with pytest.raises(InputError, match=r"no column 'roll_rad'; columns found: time_s, pitch_rad, gyro_x"):
        read_attitude_csv(path)


@pytest.mark.parametrize(
    ("scale", "unit"), [(1.0, None), (1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")]
)
def test_attitude_log_in_another_unit(tmp_path: Path, scale: float, unit: str | None) -> None:
    path = tmp_path / "log.csv"
    times = np.arange(60) / 50 * scale
    rows = (f"{t:.0f};0,1;0,2" if scale > 1 else f"{t:.2f};0,1;0,2" for t in times)
    path.write_text("time_s;roll_rad;pitch_rad\n" + "\n".join(rows))
    log = read_attitude_csv(path)
    np.testing.assert_allclose(log.times_s, np.arange(60) / 50, atol=1e-9)
    assert bool(log.notes) == bool(unit)
    assert all(unit in note for note in log.notes if unit)


@settings(max_examples=200, deadline=None)
@for_all(
    unit=st.sampled_from(["s", "ms", "us", "ns"]),
    rate=st.floats(1.0, 100.0),
    start=st.sampled_from([0.0, 30.0, 1.6e9]),
)
def test_units_named_in_the_column_are_kept(unit: str, rate: float, start: float) -> None:
    scale = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit]
    values = (start + np.arange(50) / rate) * scale
    assert clock_unit(values, unit, CAMERA_STEPS) == unit
    assert clock_unit(values, unit, LOG_STEPS) == unit


@settings(max_examples=200, deadline=None)
@for_all(
    unit=st.sampled_from(["s", "ms", "us", "ns"]),
    rate=st.floats(0.5, 200.0),
    start=st.sampled_from([0.0, 30.0, 1.6e9]),
)
def test_a_unit_that_is_not_named_is_right_or_in_doubt(unit: str, rate: float, start: float) -> None:
    scale = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit]
    values = (start + np.arange(50) / rate) * scale
    values = values if unit == "s" else np.round(values)
    for steps in (CAMERA_STEPS, LOG_STEPS):
        assert unit in possible_units(values, steps)


def possible_units(values: np.ndarray, steps: Steps) -> list[str]:
    """The unit that is found, or those that are named as possible."""
    try:
        return [clock_unit(values, None, steps)]
    except DoubtError as doubt:
        return doubt.hint.split()


def test_a_slow_clock_is_not_taken_for_another(tmp_path: Path) -> None:
    assert clock_unit(np.arange(20.0), "s", LOG_STEPS) == "s"
    assert clock_unit(np.arange(20.0) * 1.5, None, CAMERA_STEPS) == "s"
    assert clock_unit(np.array([7.0]), "s", CAMERA_STEPS) == "s"
    assert clock_unit(np.array([np.nan, 1.6e12]), None, CAMERA_STEPS) == "ms"


def test_glitches_do_not_make_degrees() -> None:
    angles = np.full(1000, 0.1)
    angles[[3, 700]] = 99.0
    assert angle_unit([angles], [], "rad") == "rad"
    assert angle_unit([angles * 0.01], [np.linspace(0, 40, 1000)], "rad") == "rad"  # counts its turns
    assert angle_unit([angles * 10.0], [np.linspace(0, 359, 1000)], None) == "deg"


def test_a_heading_in_degrees_says_nothing_of_small_angles() -> None:
    small, heading = np.linspace(-0.4, 0.4, 1000), np.linspace(0, 359, 1000)
    with pytest.raises(DoubtError, match="heading"):
        angle_unit([small, small], [heading], None)


@pytest.mark.parametrize("per_degree", [10, 100, 1000])
@pytest.mark.parametrize("named", [None, "rad", "deg"])
def test_parts_of_a_degree_are_not_taken_for_degrees(per_degree: int, named: str | None) -> None:
    pitch = 40.0 * np.sin(np.linspace(0, 20, 1000)) * per_degree
    with pytest.raises(DoubtError, match="tenths"):
        angle_unit([pitch], [], named)


@pytest.mark.parametrize(
    "name", ["roll_rate", "rollspeed", "gyro_roll_x", "target_roll", "image_width", "time_offset", "camera"]
)
def test_columns_that_only_look_alike(name: str) -> None:
    assert all(match(name, role) is None for role in KEYS)


def test_the_better_name_wins(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("timestamp,time_s,att_roll_rad,roll,roll_deg\n1,2,3,4,5\n")
    found = find_columns(read_table(path))
    assert (found["time"].name, found["roll"].name) == ("time_s", "roll_deg")


@settings(max_examples=100, deadline=None)
@for_all(value=st.floats(-1e6, 1e6), decimal=st.sampled_from(".,"))
def test_numbers(value: float, decimal: str) -> None:
    assert number(repr(value).replace(".", decimal)) == value


def test_ragged_and_cut_off_rows(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("time_s,roll_rad,pitch_rad,\n0,0.1,0.2,\n0.1,0.1,0.2,\n0.2,0.")
    log = read_attitude_csv(path)
    assert len(log.times_s) == 2


@pytest.mark.parametrize("name", ["poses.csv", "Frames.CSV", "log.txt", "data.tsv"])
def test_renamed_table_and_folder_of_images(tmp_path: Path, plain: list[FrameHeader], name: str) -> None:
    folder = write_set(tmp_path / "set", name=name, separator="\t")
    (folder / "images").rename(folder / "rgb")
    text = (folder / name).read_text()
    (folder / name).write_text(text.replace("images/", "D:\\flight\\"))
    check_same(folder, plain)
