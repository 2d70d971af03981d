"""Tables as loggers leave them: stamps in two columns, times of day, ROS messages, what power loss leaves."""

from pathlib import Path

import make_sets
import numpy as np
import pytest

from horizon_dl.data.convention import Convention
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.tables.columns import match
from horizon_dl.data.tables.iso_time import seconds_of_dates
from horizon_dl.data.tables.table import read_table
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy
from horizon_dl.logs.attitude_logs.csv_table import read as read_attitude_csv
from horizon_dl.readers.registry import open_recording

ROWS = [
    ("images/Shot_a.png", 5.0, 0.1, 0.05),
    ("images/Shot_b.png", 5.1, -0.2, 0.1),
    ("images/Shot_c.png", 5.2, 0.0, -0.15),
]
PLAIN = "image,time_s,roll_rad,pitch_rad\n" + "".join(",".join(map(str, row)) + "\n" for row in ROWS)


def opened(folder: Path, text: str | bytes) -> tuple[FrameHeader, ...]:
    for name, *_ in ROWS:
        make_sets.save_image(folder / name)
    (folder / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    (folder / "frames.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    return tuple(open_recording(folder).headers)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> tuple[FrameHeader, ...]:
    return opened(tmp_path_factory.mktemp("plain"), PLAIN)


def check_same(found: tuple[FrameHeader, ...], wanted: tuple[FrameHeader, ...]) -> None:
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted, strict=True):
        np.testing.assert_allclose(one.up_cam, other.up_cam, atol=1e-7)
        assert one.time_s - found[0].time_s == pytest.approx(other.time_s - wanted[0].time_s, abs=1e-5)


def rewritten(header: str, clock: str = "{t}", image: str = "{i}", attitude: str = "{r},{p}") -> str:
    """The rows with other words for each column."""
    lines = [header]
    for index, (name, time_s, roll, pitch) in enumerate(ROWS):
        w, x, y, z = quaternion_from_rpy(roll, pitch, 0.0)
        words = {
            **{"t": time_s, "ts": int(time_s), "tn": round(time_s % 1 * 1e9), "i": name, "r": roll},
            **{"p": pitch, "stem": Path(name).stem, "n": index, "w": w, "x": x, "y": y, "z": z},
            **{"my": -y, "mz": -z, "deg_r": np.degrees(roll), "deg_p": np.degrees(pitch)},
        }
        lines.append(",".join(cell.format(**words) for cell in (image, clock, attitude)))
    return "\n".join(lines) + "\n"


ANGLES = "roll_rad,pitch_rad"


@pytest.mark.parametrize(
    "text",
    [
        rewritten(f"image,sec,nanosec,{ANGLES}", "{ts},{tn}"),
        rewritten(f"image,header.stamp.secs,header.stamp.nsecs,{ANGLES}", "{ts},{tn}"),
        rewritten(f"image,stamp_sec,stamp_nanosec,{ANGLES}", "{ts},{tn}"),
        rewritten(f"image,time,{ANGLES}", "00:00:{t:04.1f}"),
        rewritten(f"image,time,{ANGLES}", "23:59:{t:06.3f}"),
        rewritten(f"image,date,time,{ANGLES}", "2024-05-01,12:00:{t:04.1f}"),
        rewritten(f"image,time_s,{ANGLES}", image="{stem}"),
        rewritten(f"image,time_s,{ANGLES}", image="IMAGES/{stem}.PNG").replace("Shot", "SHOT"),
        rewritten(f"image,time_s,{ANGLES}", image="images/{stem}.jpg"),
        rewritten("image,time_s,qx,qy,qz,qw", attitude="{x},{y},{z},{w}"),
        rewritten(
            "image,time_s,pose.orientation.x,pose.orientation.y,pose.orientation.z,pose.orientation.w",
            attitude="{x},{my},{mz},{w}",
        ),
        PLAIN.encode() + b"\0" * 512,
        PLAIN.encode("utf-32"),
    ],
)
def test_a_table_is_read_as_the_plain_one(
    tmp_path: Path, plain: tuple[FrameHeader, ...], text: str | bytes
) -> None:
    check_same(opened(tmp_path, text), plain)


def test_a_ros_messages_quaternion_keeps_its_convention(tmp_path: Path) -> None:
    names = ",".join(f"field.pose.pose.orientation.{axis}" for axis in "xyzw")
    text = rewritten(f"image,time_s,{names}", attitude="{x},{my},{mz},{w}")
    opened(tmp_path, text)
    recording = open_recording(tmp_path)
    assert recording.reading is not None
    assert recording.reading.convention == Convention("flu", "z")
    again = recording.read_as("frd z-down")
    assert not np.allclose(again.headers[0].up_cam, recording.headers[0].up_cam)
    assert any("ROS message" in note for note in recording.notes)


@pytest.mark.parametrize("cut", range(1, 12))
def test_power_loss_in_the_last_row(tmp_path: Path, plain: tuple[FrameHeader, ...], cut: int) -> None:
    """What is left of the last number is no attitude, or the right one to the digits that are left."""
    long = (
        PLAIN.replace("0.1,", "0.100000,")
        .replace("-0.15", "-0.150000")
        .replace("0.05", "0.050000")
        .replace("0.1\n", "0.100000\n")
    )
    found = opened(tmp_path, long[:-cut].encode() + b"\0" * 64)
    check_same(found[:2], plain[:2])
    last = found[2].up_cam
    assert last is None or np.degrees(np.arccos(np.clip(last @ plain[2].up_cam, -1, 1))) < 1e-3


def test_a_log_that_power_loss_cut_off(tmp_path: Path) -> None:
    lines = [f"{0.02 * k:.3f},{0.123456:.6f},{-0.12345:.6f}" for k in range(20)]
    path = tmp_path / "log.csv"
    path.write_bytes(("time_s,roll_rad,pitch_rad\n" + "\n".join(lines)).encode()[:-5] + b"\0" * 4096)
    assert len(read_attitude_csv(path).times_s) == 19


def test_short_last_cells_that_are_whole_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time_s,roll_rad,note\n1.0,0.1,\n2.0,0.2,\n3.0,0.3,\n")
    assert read_table(path).texts("roll_rad") == ["0.1", "0.2", "0.3"]


def test_times_of_day_go_on_past_midnight() -> None:
    found = seconds_of_dates(["23:59:59.5", "", "00:00:00.5", "00:00:01,5"])
    assert found is not None
    np.testing.assert_allclose(found, [86399.5, np.nan, 86400.5, 86401.5])
    assert seconds_of_dates(["12:00:00", "soon"]) is None


@pytest.mark.parametrize("name", ["orientation", "disorientation.x", "orientation.u", "orientation.x.sigma"])
def test_columns_that_only_look_like_a_messages(name: str) -> None:
    assert match(name, "qx") is None


BEFORE = {
    "a flight recorder": '"Product","Blackbox flight data recorder"\n"Firmware","4.5"\n"looptime","125"\n',
    "a device": "Device: IMU 7\nRecorded on 2024-05-01, 12:00\n\nSerial number;123\n",
    "names of few": "name,value\nrate,200\n",
}


@pytest.mark.parametrize("before", BEFORE.values(), ids=BEFORE)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_what_a_device_says_of_itself_stands_before_the_table(
    tmp_path: Path, before: str, separator: str
) -> None:
    rows = ["time_s,roll_rad,pitch_rad,yaw_rad", *(f"{k / 10},0.1,-0.2,{k / 100}" for k in range(80))]
    text = "\n".join(row.replace(",", separator) for row in rows)
    (tmp_path / "plain.csv").write_text(text)
    (tmp_path / "log.csv").write_text(before + text)
    plain, log = (read_attitude_csv(tmp_path / name) for name in ("plain.csv", "log.csv"))
    np.testing.assert_array_equal(log.times_s, plain.times_s)
    np.testing.assert_array_equal(log.quaternions, plain.quaternions)


@pytest.mark.parametrize("place", range(4))
def test_a_cell_without_an_end_is_one_line(tmp_path: Path, place: int) -> None:
    lines = ["time_s,roll_rad,pitch_rad", "0,1,2", "1,2,3"]
    lines.insert(place, '1,2,"' + "a" * 200_000)
    (tmp_path / "log.csv").write_text("\n".join(lines))
    with pytest.raises(InputError, match="is not a CSV file"):
        read_attitude_csv(tmp_path / "log.csv")


SWINGS = [(k / 10, 5.0 * (k % 5), -10.0 + k % 7, 3.0 * k) for k in range(60)]


def with_columns(path: Path, header: str, *cells: str) -> tuple[str, ...]:
    """Notes of a log of swinging roll, pitch and yaw, degrees, with more columns beside them."""
    lines = [f"time_s,roll_deg,pitch_deg,yaw_deg{header}"]
    lines += [",".join([*(f"{value:g}" for value in row), *cells]) for row in SWINGS]
    path.write_text("\n".join(lines))
    return tuple(note for note in read_attitude_csv(path).notes if isinstance(note, Doubt))


def test_a_gimbal_beside_the_vehicles_attitude_is_said(tmp_path: Path) -> None:
    for header, cell in ((",gimbalPitchRaw", "-300"), (",gimbal_pitch(degrees)", "-30")):
        (note,) = with_columns(tmp_path / "log.csv", header, cell)
        assert "the attitude is the vehicle's" in note
        assert header.strip(",") in note
    assert not with_columns(tmp_path / "log.csv", ",gimbal_pitch", "0.0")
    assert not with_columns(tmp_path / "log.csv", ",gimbal_mode", "3")


def test_an_attitude_of_zeros_is_said(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(
        "time_s,qx,qy,qz,qw\n" + "".join(f"{k / 10},0,0,0,1\n" for k in range(9))
    )
    (note,) = read_attitude_csv(tmp_path / "log.csv").notes
    assert "turns nothing in any row" in note


def test_a_trajectory_is_said_to_be_one(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10} 1 2 3 0.{k} 0 0 1\n" for k in range(1, 9))
    (tmp_path / "log.txt").write_text("# timestamp tx ty tz qx qy qz qw\n" + rows)
    (note,) = read_attitude_csv(tmp_path / "log.txt").notes
    assert isinstance(note, Doubt)
    assert "as of a trajectory" in note


@pytest.mark.parametrize("factor", [10.0, 100.0])
def test_no_pitch_is_over_a_right_angle_by_much(tmp_path: Path, factor: float) -> None:
    rows = [f"{t:g},{roll * factor:g},{(pitch - 5) * factor:g}" for t, roll, pitch, _ in SWINGS]
    for header in ("time_s,roll,pitch", "time_s,roll_deg,pitch_deg"):
        (tmp_path / "log.csv").write_text("\n".join([header, *rows]))
        with pytest.raises(InputError, match=r"no pitch is|over a full turn"):
            read_attitude_csv(tmp_path / "log.csv")


def test_a_clock_of_whole_seconds_is_said(tmp_path: Path) -> None:
    rows = "".join(f"{k // 10},0.1,-0.{k % 9}\n" for k in range(60))
    (tmp_path / "log.csv").write_text("time_s,roll_rad,pitch_rad\n" + rows)
    assert any(
        "most rows have the time of the row before" in note
        for note in read_attitude_csv(tmp_path / "log.csv").notes
    )


def test_microseconds_beside_whole_seconds_count(tmp_path: Path) -> None:
    rows = "".join(f"{k // 10},{k % 10 * 100_000},0.1,-0.{k % 9}\n" for k in range(60))
    (tmp_path / "log.csv").write_text("stamp_sec,stamp_usec,roll_rad,pitch_rad\n" + rows)
    np.testing.assert_allclose(read_attitude_csv(tmp_path / "log.csv").times_s, np.arange(60) / 10)


def test_days_of_a_spreadsheet_are_not_taken_for_seconds(tmp_path: Path) -> None:
    rows = "".join(f"{45047.5 + k / 864000:.9f},0.1,-0.{k % 9}\n" for k in range(60))
    (tmp_path / "log.csv").write_text("time,roll_rad,pitch_rad\n" + rows)
    with pytest.raises(InputError, match="days times 86400"):
        read_attitude_csv(tmp_path / "log.csv")


def test_a_line_of_units_below_the_names_counts(tmp_path: Path) -> None:
    rows = "".join(f"{k * 100},{k % 5},{-k % 7}\n" for k in range(60))
    (tmp_path / "log.csv").write_text("time,roll,pitch\n(ms),(deg),(deg)\n" + rows)
    (tmp_path / "plain.csv").write_text("time_ms,roll_deg,pitch_deg\n" + rows)
    logs = [read_attitude_csv(tmp_path / name) for name in ("log.csv", "plain.csv")]
    np.testing.assert_array_equal(logs[0].times_s, logs[1].times_s)
    np.testing.assert_array_equal(logs[0].quaternions, logs[1].quaternions)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("first", ["", "# 飛行ログのデータ\n", "# \U0001f681\U0001f681\U0001f681\n"])
def test_letters_of_any_script_may_stand_anywhere(tmp_path: Path, first: str, encoding: str) -> None:
    rows = "".join(f"{k / 10},{k % 5},{-k % 7}\n" for k in range(60))
    text = f"{first}timestamp [s],roll [°],pitch [°]\n{rows}"
    for shift in range(12):
        (tmp_path / "log.csv").write_bytes(("#" * shift + "\n" + text).encode(encoding))
        assert len(read_attitude_csv(tmp_path / "log.csv").times_s) == 60


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_the_head_of_a_long_table_is_cut_between_lines(tmp_path: Path, encoding: str) -> None:
    lines = ["name,vålue", *(f"{k},é飛\U0001f681" for k in range(300))]
    (tmp_path / "a.csv").write_bytes("\n".join(lines).encode(encoding))
    whole = read_table(tmp_path / "a.csv")
    for head_bytes in range(200, 240):
        head = read_table(tmp_path / "a.csv", head_bytes)
        assert head.names == whole.names
        assert head.rows == whole.rows[: len(head.rows)]
        assert 3 < len(head.rows) < 60


def test_a_pitch_that_counts_on_is_one(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10},5,{(355 + k % 10) % 360}\n" for k in range(60))
    (tmp_path / "log.csv").write_text("time_s,roll_deg,pitch_deg\n" + rows)
    assert len(read_attitude_csv(tmp_path / "log.csv").times_s) == 60


def test_microseconds_of_the_whole_time_are_not_added(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10},{k * 100_000},5,{k % 9}\n" for k in range(60))
    (tmp_path / "log.csv").write_text("time_sec,time_usec,roll_deg,pitch_deg\n" + rows)
    np.testing.assert_allclose(read_attitude_csv(tmp_path / "log.csv").times_s, np.arange(60) / 10)


@pytest.mark.parametrize("header", ["time", "seconds,ts", "device_timestamp,cts"])
def test_a_fast_clock_and_counters_beside_it(tmp_path: Path, header: str) -> None:
    beside = header.count(",")
    rows = "".join(f"{k / 2500:.4f}{',7' * beside},5,{k % 9}\n" for k in range(60))
    (tmp_path / "log.csv").write_text(f"{header},roll_deg,pitch_deg\n{rows}")
    np.testing.assert_allclose(read_attitude_csv(tmp_path / "log.csv").times_s, np.arange(60) / 2500)


def test_a_part_of_a_quaternion_is_no_trajectory(tmp_path: Path) -> None:
    assert not with_columns(tmp_path / "log.csv", ",qi,tx,ty,tz", "1", "1", "2", "3")
