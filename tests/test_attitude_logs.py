"""Attitude logs of every kind: against their own libraries where there is one, else by hand."""

import contextlib
import math
import os
import struct
from pathlib import Path

import numpy as np
import pytest
from fuzz.logs import dataflash_bytes, dataflash_text, mars_table, subtitles, ulog_bytes
from pyulog.ulog2csv import convert_ulog2csv

from horizon_dl.data.attitude_log import AttitudeLog, angles_of_ups
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import rotation_from_quaternion, rpy_from_rotation
from horizon_dl.logs.attitude_logs import gopro_track, klv
from horizon_dl.logs.attitude_logs.inertial import log_of_inertial, ups_of_inertial
from horizon_dl.logs.attitude_logs.phone_axes import frd_from_phone
from horizon_dl.logs.attitude_logs.registry import read_attitude_log

LOGS = Path(os.environ.get("HORIZON_DL_LOGS", "none"))
needs_logs = pytest.mark.skipif(not LOGS.is_dir(), reason="needs HORIZON_DL_LOGS")


def rpy_deg(log: AttitudeLog) -> np.ndarray:
    return np.rad2deg([rpy_from_rotation(rotation_from_quaternion(q)) for q in log.quaternions])


@needs_logs
@pytest.mark.parametrize("name", ["sample_log_small.ulg", "sample_appended_multiple.ulg"])
def test_a_ulog_is_what_pyulogs_own_table_says(tmp_path: Path, name: str) -> None:
    path = LOGS / "ulog" / name
    convert_ulog2csv(str(path), "vehicle_attitude", str(tmp_path), ",", None, None)
    table = next(tmp_path.glob("*vehicle_attitude_0.csv")).read_text().splitlines()
    columns = table[0].split(",")
    rows = np.array([[float(cell) for cell in line.split(",")] for line in table[1:]])
    quaternions = rows[:, [columns.index(f"q[{index}]") for index in range(4)]]
    log = read_attitude_log(path)
    np.testing.assert_allclose(log.times_s, rows[:, columns.index("timestamp")] * 1e-6)
    np.testing.assert_allclose(log.quaternions, quaternions, atol=1e-5)


@needs_logs
def test_a_ulog_that_a_power_cut_ended_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    whole = (LOGS / "ulog" / "sample_log_small.ulg").read_bytes()
    (tmp_path / "cut.ulg").write_bytes(whole[: len(whole) * 3 // 4])
    cut, log = (
        read_attitude_log(tmp_path / "cut.ulg"),
        read_attitude_log(LOGS / "ulog" / "sample_log_small.ulg"),
    )
    assert 0.4 * len(log.times_s) < len(cut.times_s) < len(log.times_s)
    np.testing.assert_array_equal(cut.quaternions, log.quaternions[: len(cut.quaternions)])


@pytest.mark.parametrize("data", [b"ULog\x01\x12\x35" + b"\x01" * 9 + b"\xff" * 50, b"ULog\x01\x12\x35"])
def test_a_ulog_of_nothing_is_one_line(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.ulg").write_bytes(data)
    with pytest.raises(InputError, match=r"a\.ulg"):
        read_attitude_log(tmp_path / "a.ulg")


def test_a_ulog_cut_in_its_definitions_ends(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """pyulog goes back by the size that a cut message states, and reads the same bytes for ever."""
    whole = ulog_bytes()
    outcomes = set()
    for cut in range(17, 400, 3):
        for size in (b"\x20\x00", b"\xff\x00"):
            (tmp_path / "a.ulg").write_bytes(whole[:cut] + size + b"\x00" + whole[cut : cut + 40])
            try:
                read_attitude_log(tmp_path / "a.ulg")
                outcomes.add("read")
            except InputError as error:
                outcomes.add(str(error).split("; ")[-1])
    assert "copy it from the card again" in outcomes
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", [b"timestamp", b"q;", b"float[4]", b"uint64_t", b"dist_bottom;"])
def test_a_ulog_whose_fields_have_other_names_or_types(tmp_path: Path, name: bytes) -> None:
    whole = ulog_bytes()
    for other in (b"x" * len(name), b"char[8] "[: len(name)].ljust(len(name)), b" " * len(name)):
        (tmp_path / "a.ulg").write_bytes(whole.replace(name, other))
        with contextlib.suppress(InputError):
            assert len(read_attitude_log(tmp_path / "a.ulg").times_s)


@pytest.mark.parametrize("length", [0, 1, 2, 3, 4, 19, 255])
def test_a_dataflash_format_of_any_length_ends(tmp_path: Path, length: int) -> None:
    """pymavlink reads the same message again and again where its format states no length."""
    whole = bytearray(dataflash_bytes())
    place = whole.index(b"\x0a\x17ATT\0")
    whole[place + 1] = length
    (tmp_path / "a.bin").write_bytes(whole)
    with contextlib.suppress(InputError):
        read_attitude_log(tmp_path / "a.bin")


@pytest.mark.parametrize("hours", ["9" * 400, "9" * 5000, "1000000"])
def test_subtitles_of_an_hour_that_cannot_be(tmp_path: Path, hours: str) -> None:
    lines = subtitles().decode().replace("\n00:00:00,040", f"\n{hours}:00:00,040")
    (tmp_path / "a.srt").write_text(lines)
    assert len(read_attitude_log(tmp_path / "a.srt").times_s) == 9


def test_rows_of_dataflash_that_hold_no_numbers_are_left_out(tmp_path: Path) -> None:
    lines = dataflash_text().decode().splitlines()
    attitudes = [index for index, line in enumerate(lines) if line.startswith("ATT")]
    for index, cell in zip(attitudes, ("x", "nan", "1e999", "", "²"), strict=False):
        parts = lines[index].split(", ")
        lines[index] = ", ".join([*parts[:2], cell, *parts[3:]])
    lines[attitudes[5]] = "ATT, 1500000"
    (tmp_path / "a.log").write_text("\n".join([*lines, ""]))
    log = read_attitude_log(tmp_path / "a.log")
    assert np.unique(log.times_s) == pytest.approx([1.6, 1.7, 1.8, 1.9])
    assert log.shutter is not None


@pytest.mark.parametrize(
    "columns", ["TimeUS,Roll,Pitch,Yaw", "TimeUS,A,B,C,Roll,Pitch,Yaw", "Roll", "Yaw,Yaw"]
)
@pytest.mark.parametrize("letters", ["Qfff", "Q", "Qf", "fff"])
def test_a_dataflash_format_whose_names_and_letters_differ_in_number(
    tmp_path: Path, columns: str, letters: str
) -> None:
    """Of a damaged header: what is told is left out, and nothing else happens."""
    whole = dataflash_bytes()
    header = struct.pack("<4s16s64s", b"ATT", b"Qfff", b"TimeUS,Roll,Pitch,Yaw")
    damaged = struct.pack("<4s16s64s", b"ATT", letters.encode(), columns.encode())
    path = tmp_path / "damaged.BIN"
    path.write_bytes(whole.replace(header, damaged))
    with contextlib.suppress(InputError):
        assert np.isfinite(read_attitude_log(path).times_s).all()


@needs_logs
def test_dataflash_is_in_degrees_from_boot_and_quiet(capfd: pytest.CaptureFixture[str]) -> None:
    log = read_attitude_log(LOGS / "dataflash" / "test.BIN")
    assert len(log.times_s) == 24
    # The first row by mavlogdump: TimeUS 81795644, Roll -7.18, Pitch 2.58, Yaw 337.1.
    assert log.times_s[0] == pytest.approx(81.795644)
    assert rpy_deg(log)[0] == pytest.approx([-7.18, 2.58, 337.1 - 360], abs=0.01)
    assert log.unix_start_s == pytest.approx(1509241629.94, abs=0.1)
    assert capfd.readouterr() == ("", "")


@needs_logs
def test_damage_in_a_dataflash_log_is_noted_and_not_printed(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    data = bytearray((LOGS / "dataflash" / "test.BIN").read_bytes())
    data[60000:60050] = b"\0" * 50
    (tmp_path / "a.bin").write_bytes(data)
    log = read_attitude_log(tmp_path / "a.bin")
    assert len(log.times_s) >= 20
    assert capfd.readouterr() == ("", "")


def test_a_text_log_with_pictures_knows_the_attitude_at_the_shutter(tmp_path: Path) -> None:
    formats = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 10, 30, ATT, Qfff, TimeUS,Roll,Pitch,Yaw",
        "FMT, 11, 30, CAM, Qfff, TimeUS,Roll,Pitch,Yaw",
    ]
    rows = [f"ATT, {1000000 + 100000 * n}, {n}, 1.5, 359.0" for n in range(10)]
    rows.insert(5, "CAM, 1450000, 4.6, 1.4, 358.0")
    (tmp_path / "a.log").write_text("\n".join([*formats, *rows]) + "\n")
    log = read_attitude_log(tmp_path / "a.log")
    assert log.times_s == pytest.approx(1 + 0.1 * np.arange(10))
    assert log.shutter is not None
    assert log.shutter.times_s == pytest.approx([1.45])
    assert rpy_deg(log.shutter)[0] == pytest.approx([4.6, 1.4, -2.0], abs=1e-4)


@needs_logs
def test_the_avatas_subtitles_have_the_gimbals_attitude() -> None:
    log = read_attitude_log(LOGS / "dji_srt" / "Avata360_clip.SRT")
    assert log.times_s[:2] == pytest.approx([0.0, 0.041])
    assert rpy_deg(log)[0] == pytest.approx([0.0, 0.0, -162.8])


@needs_logs
@pytest.mark.parametrize(
    "name", ["MAVIC3.srt", "air2s.srt", "mavic_pro.SRT", "mini4pro_clip.SRT", "old_format.SRT"]
)
def test_other_subtitles_say_which_camera_writes_attitude(name: str) -> None:
    with pytest.raises(InputError, match="Avata 360"):
        read_attitude_log(LOGS / "dji_srt" / name)


@needs_logs
def test_stabilisation_is_not_taken_for_attitude() -> None:
    with pytest.raises(InputError, match="stabilisation"):
        read_attitude_log(LOGS / "dji_srt" / "neo2_clip.SRT")


@needs_logs
def test_goPros_gravity_is_what_the_levelled_film_was_checked_with() -> None:  # noqa: N802
    log = read_attitude_log(LOGS / "gopro_max" / "max-heromode.mp4")
    # The set `gopro_max_path` was made from this film by other code; first, middle and last frame, rad.
    data = Path(os.environ["HORIZON_DL_DATA"]) / "gopro_max_path" / "frames.csv"
    rows = [line.split(",") for line in data.read_text().splitlines()[1:]]
    for row in rows[:: len(rows) // 5]:
        nearest = int(np.abs(log.times_s - float(row[1])).argmin())
        roll, pitch, _ = np.deg2rad(rpy_deg(log)[nearest])
        assert (roll, pitch) == pytest.approx((float(row[2]), float(row[3])), abs=2e-3)


@needs_logs
def test_gyroscope_and_accelerometer_agree_with_goPros_gravity() -> None:  # noqa: N802
    path = LOGS / "gopro_max" / "max-heromode.mp4"
    found, end_s = gopro_track.read_streams(path, ("GRAV", "ACCL", "GYRO"))
    gravity = gopro_track._of_gravity(*found["GRAV"].joined(end_s), None, end_s)
    gyro, force = (gopro_track._in_body(found[key], end_s) for key in ("GYRO", "ACCL"))
    inertial = log_of_inertial(gyro, force, np.eye(3))
    for axis in (0, 1):
        ours = np.interp(gravity.times_s, inertial.times_s, rpy_deg(inertial)[:, axis])
        assert np.abs(ours - rpy_deg(gravity)[:, axis]).mean() < 1.5
        assert np.corrcoef(np.diff(ours), np.diff(rpy_deg(gravity)[:, axis]))[0, 1] > 0.9


def item(key: bytes, kind: bytes, size: int, count: int, data: bytes) -> bytes:
    return key + kind + struct.pack(">BH", size, count) + data + b"\0" * (-len(data) % 4)


def test_klv_is_read_as_gopro_writes_it() -> None:
    scale = item(b"SCAL", b"s", 2, 1, struct.pack(">h", 100))
    accel = item(b"ACCL", b"s", 6, 2, struct.pack(">6h", 100, -200, 981, 0, 1, 2))
    types = item(b"TYPE", b"c", 1, 3, b"Lfq")
    mixed = item(b"ATTD", b"?", 12, 1, struct.pack(">Ifi", 1500, 0.25, 1 << 15))
    inner = item(b"STRM", b"\0", 1, len(scale + accel), scale + accel)
    other = item(b"STRM", b"\0", 1, len(types + mixed), types + mixed)
    device = item(b"DEVC", b"\0", 1, len(inner + other), inner + other)
    first, second = klv.streams(device)
    assert klv.samples(first, "ACCL").tolist() == [[1.0, -2.0, 9.81], [0.0, 0.01, 0.02]]
    assert klv.samples(second, "ATTD").tolist() == [[1500.0, 0.25, 0.5]]
    for cut in range(len(device)):
        list(klv.streams(device[:cut]))


def test_up_and_angles() -> None:
    roll, pitch = math.radians(20), math.radians(-30)
    up = -np.array([-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll)])
    assert np.rad2deg(angles_of_ups(up[None]))[0] == pytest.approx([20, -30, 0])


@pytest.mark.parametrize("up", [[0, 9.8, 1.0], [9.8, 0, 1.0], [-9.8, 0, 1.0], [0, -9.8, 1.0]])
def test_a_phone_is_upright_however_it_is_held(up: list[float]) -> None:
    forward, right, down = frd_from_phone(up) @ up
    assert (forward, right, down) == pytest.approx((-1.0, 0.0, -9.8))  # the top leans forward: it looks down


def phone_folder(folder: Path, metadata: str, sign: float) -> Path:
    folder.mkdir()
    header = "time,seconds_elapsed,z,y,x"
    rows = [f"{1700000000000000000 + n * 10**7},{n / 100},{sign * 1.7},{sign * 9.66},0.0" for n in range(20)]
    (folder / "Gravity.csv").write_text("\n".join([header, *rows]) + "\n")
    (folder / "Metadata.csv").write_text(metadata)
    return folder


@pytest.mark.parametrize(
    ("metadata", "sign"),
    [
        ("platform,standardisation\nandroid,false\n", 1.0),
        ("platform,standardisation\nios,true\n", 1.0),
        ("platform,standardisation\nios,false\n", -1.0),
        ("version,platform\n2,iOS\n", -1.0),
    ],
)
def test_sensor_logger_by_system(tmp_path: Path, metadata: str, sign: float) -> None:
    log = read_attitude_log(phone_folder(tmp_path / "export", metadata, sign))
    assert rpy_deg(log)[0] == pytest.approx([0.0, -9.98, 0.0], abs=0.01)
    assert log.times_s[0] == pytest.approx(1.7e9)
    assert not log.has_yaw


def test_after_a_pause_in_which_it_was_turned_up_is_right_again() -> None:
    times_s = np.concatenate([np.arange(0, 5, 0.01), np.arange(30, 35, 0.01)])
    tilt = np.where(times_s < 10, 0.0, np.radians(70.0))
    forces = 9.81 * np.stack([np.sin(tilt), np.zeros_like(tilt), np.cos(tilt)], axis=-1)
    ups = ups_of_inertial(times_s, np.zeros((len(times_s), 3)), forces)
    np.testing.assert_allclose(ups / np.linalg.norm(ups, axis=1, keepdims=True), forces / 9.81, atol=1e-6)


def test_a_start_under_way_is_no_tilt() -> None:
    times_s = np.arange(0, 40, 0.01)
    speeding_up = np.where(times_s < 3, 2.0, np.where(times_s > 37, -2.0, 0.0))
    forces = np.column_stack([speeding_up, np.zeros_like(times_s), np.full_like(times_s, -9.81)])
    log = log_of_inertial((times_s, np.zeros((len(times_s), 3))), (times_s, forces), np.eye(3))
    assert np.abs(rpy_deg(log)).max() < 4.0  # one that only knows the past says 11.5


@pytest.mark.parametrize("cell", ["1e200", "-1e30", "inf", "nan", "1e4000"])
@pytest.mark.parametrize("place", range(7))
def test_what_no_sensor_measures_is_left_out(tmp_path: Path, cell: str, place: int) -> None:
    lines = mars_table().decode().splitlines()
    wanted = lines.pop(20)
    (tmp_path / "gyro_accel.csv").write_text("\n".join(lines))
    without = read_attitude_log(tmp_path / "gyro_accel.csv")
    cells = wanted.split(",")
    cells[place] = cell
    (tmp_path / "gyro_accel.csv").write_text("\n".join([*lines[:20], ",".join(cells), *lines[20:]]))
    log = read_attitude_log(tmp_path / "gyro_accel.csv")
    np.testing.assert_array_equal(log.times_s, without.times_s)
    np.testing.assert_array_equal(log.quaternions, without.quaternions)


def test_a_log_on_another_clock() -> None:
    log = AttitudeLog(np.array([1e9, 1e9 + 1000]), np.array([[1.0, 0, 0, 0]] * 2))
    moved = log.on_clock(-1e9 + 5, 100.0)
    assert moved.times_s == pytest.approx([5.0, 1005.1])


@pytest.mark.parametrize(
    "data", [b"", b"\xa3\x95" + b"\xff" * 300, b"FMT, 1\n", b"1\n00:00:00,000 --> 00:00:01,000\n"]
)
def test_logs_of_nothing_are_one_line(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "log.bin").write_bytes(data)
    with pytest.raises(InputError, match=r"log.bin"):
        read_attitude_log(tmp_path / "log.bin")
