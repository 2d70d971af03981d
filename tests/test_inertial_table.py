"""A table of gyroscope and accelerometer as `--attitude`: columns, units, axes, and what is refused."""

import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from imu_tables import HEADER, Floats, flight, imu_samples, write_imu
from scipy.spatial.transform import Rotation

from horizon_dl.calibration.mount import AxesNotStatedError
from horizon_dl.cli import main
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.given import Given
from horizon_dl.data.tables.inertial_columns import inertial_columns
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.registry import read_attitude_log
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set

DATA = Path(os.environ.get("HORIZON_DL_DATA", "none"))


def angles_apart_deg(first: Floats, second: Floats) -> Floats:
    return np.degrees(np.arccos(np.clip(np.sum(first * second, axis=-1), -1.0, 1.0)))


def ups(attitudes: Rotation) -> Floats:
    return attitudes.inv().apply([0.0, 0.0, -1.0])


DIALECTS = {
    "own": (HEADER, ",", (1, 1, 1)),
    "degrees": ("t;gx [deg/s];gy [deg/s];gz [deg/s];ax [g];ay [g];az [g]", ";", (1, np.rad2deg(1), 1 / 9.81)),
    "counts": ("millis,GyrX(dps),GyrY(dps),GyrZ(dps),AccX,AccY,AccZ", ",", (1e3, np.rad2deg(1), 2048 / 9.81)),
    "EuRoC": (
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]", ",", (1e9, 1, 1)),
    "PX4": ("timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],"
            "accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2]", ",", (1e6, 1, 1)),
    "ROS": ("time,field.angular_velocity.x,field.angular_velocity.y,field.angular_velocity.z,"
            "field.linear_acceleration.x,field.linear_acceleration.y,field.linear_acceleration.z", ",",
            (1e9, 1, 1)),
}  # fmt: skip


@pytest.mark.parametrize("axes", ["frd", "flu", "ulb", "rdf"])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_attitude_is_that_of_the_flight(tmp_path: Path, dialect: str, axes: str) -> None:
    header, separator, scale = DIALECTS[dialect]
    times_s, attitudes = flight()
    samples = imu_samples(times_s, attitudes, axes)
    path = write_imu(tmp_path / "imu.csv", samples * np.repeat(scale, [1, 3, 3]), header, separator)
    log = read_attitude_log(path, Given(imu_axes=axes))
    assert log.of_imu
    np.testing.assert_allclose(log.times_s, samples[:, 0], atol=1e-5)
    found = Rotation.from_quat(np.roll(log.quaternions, -1, axis=1))
    inside = log.times_s < times_s[-1]
    np.testing.assert_allclose(
        ups(found)[inside][:: len(times_s) // 40],
        imu_samples(times_s, attitudes, "frd")[inside][:: len(times_s) // 40, 4:] / 9.81,
        atol=0.01,
    )


XYZ = ("x", "y", "z")


def three(name: str, unit: str = "") -> str:
    return ",".join(name.format(axis) + unit for axis in XYZ)


@pytest.mark.parametrize(
    ("header", "rates", "forces"),
    [
        ("t,ax,ay,az,gx,gy,gz", "gx", "ax"),
        ("time,gFx,gFy,gFz,wx,wy,wz", "wx", "gFx"),
        ("t,x_gyro,y_gyro,z_gyro,x_acc,y_acc,z_acc,x_mag,y_mag,z_mag", "x_gyro", "x_acc"),
        (f"t,{three('ang_vel_{}')},{three('lin_acc_{}')}", "ang_vel_x", "lin_acc_x"),
        (f"{three('linear acceleration {}')},{three('accelerometer {}')},{three('gyroscope {}')}",
         "gyroscope x", "accelerometer x"),
        (f"t,{three('gyro_{}_bias')},{three('gyro_{}')},{three('acc_{}')}", "gyro_x", "acc_x"),
        ("t,gyro_x_raw,gyro_x_dps,gyro_y_dps,gyro_y_raw,gyro_z_dps,acc_x,acc_y,acc_z", "gyro_x_dps", "acc_x"),
        (f"t,{three('imu0_gyro_{}')},{three('imu1_acc_{}')},{three('imu1_gyro_{}')}",
         "imu1_gyro_x", "imu1_acc_x"),
        (f"t,{three('left_gyro_{}')},{three('right_acc_{}')}", None, None),
        (f"t,{three('setpoint_rate_{}')},{three('acc_{}')}", None, None),
        (f"t,{three('world_acc_{}')},{three('gyro_{}')}", None, None),
        (f"t,{three('userAcceleration{}')},{three('rotationRate{}')}", None, None),
        (f"t,{three('gyro_{}', '[mdps]')},{three('acc_{}', '[mg]')}", None, None),
        ("t,acc_x,acc_y,gyro_x,gyro_y,gyro_z", None, None),
        ("t,mag_x,mag_y,mag_z,acc_x,acc_y,acc_z", None, None),
        ("t,roll,pitch,max,relax,axis,proxy,topaz", None, None),
    ],
)  # fmt: skip
def test_columns_by_their_names(header: str, rates: str | None, forces: str | None) -> None:
    found = inertial_columns(header.split(","))
    assert (found and found.rates[0], found and found.forces[0]) == (rates, forces)


@pytest.mark.parametrize(("factor", "word"), [(1.0, "radians"), (np.rad2deg(1.0), "degrees")])
def test_a_unit_without_a_name_is_told_by_the_accelerometer(tmp_path: Path, factor: float, word: str) -> None:
    samples = imu_samples(*flight(swing=2.0), "flu")
    named = write_imu(tmp_path / "named.csv", samples)
    header = HEADER.replace("_rad_s", "")
    path = write_imu(tmp_path / "imu.csv", samples * np.repeat([1, factor, 1], [1, 3, 3]), header)
    log = read_attitude_log(path, Given(imu_axes="flu"))
    np.testing.assert_allclose(
        log.quaternions, read_attitude_log(named, Given(imu_axes="flu")).quaternions, atol=1e-6
    )
    assert any(f"read as {word}" in note for note in log.notes)


def test_a_table_with_attitudes_is_read_by_them(tmp_path: Path) -> None:
    header = "time_s,roll_rad,pitch_rad,gx,gy,gz,ax,ay,az"
    rows = "".join(f"{t / 50},0.1,-0.2,0,0,0,0,0,-9.8\n" for t in range(50))
    (tmp_path / "log.csv").write_text(f"{header}\n{rows}")
    log = read_attitude_log(tmp_path / "log.csv")
    assert not log.of_imu


def test_axes_are_asked_for(tmp_path: Path) -> None:
    path = write_imu(tmp_path / "imu.csv", imu_samples(*flight(5.0), "flu"))
    with pytest.raises(AxesNotStatedError, match="--imu-axes flu"):
        read_attitude_log(path)
    with pytest.raises(InputError, match="not right-handed"):
        read_attitude_log(path, Given(imu_axes="fru"))


NO_UNIT = HEADER.replace("_rad_s", "")
RAW = NO_UNIT.replace("_m_s2", "")


@pytest.mark.parametrize(
    ("scale", "header", "says"),
    [
        ((1, 1, 0.06), HEADER, "neither 9.8 m/s"),  # no gravity in it
        ((1, 2, 1), HEADER, "if its rates are taken times 0.5"),
        ((2, 1, 1), HEADER, "if its rates are taken times 0.5"),
        ((1, 1, 0), HEADER, "neither 9.8 m/s"),
        ((1, np.rad2deg(1.0), 1), HEADER, "do not agree"),
        ((1, np.rad2deg(131.0), 16384 / 9.81), RAW, "do not agree"),  # counts of an MPU-6050
        ((1, 1e9, 1), HEADER, "do not agree"),
        ((1, float("nan"), 1), HEADER, "under 10 samples"),
    ],
)
def test_what_is_not_certain_is_one_line(
    tmp_path: Path, scale: tuple[float, ...], header: str, says: str
) -> None:
    samples = imu_samples(*flight(swing=2.0), "flu") * np.repeat(scale, [1, 3, 3])
    path = write_imu(tmp_path / "imu.csv", samples, header)
    with pytest.raises(InputError, match=says):
        read_attitude_log(path, Given(imu_axes="flu"))


def test_of_an_imu_that_hardly_turns_the_unit_is_asked_for(tmp_path: Path) -> None:
    times_s, attitudes = flight()
    still = Rotation.from_rotvec(0.002 * attitudes.as_rotvec())
    path = write_imu(tmp_path / "imu.csv", imu_samples(times_s, still, "flu"), NO_UNIT)
    with pytest.raises(InputError, match="the rates have no unit; --angle-unit rad or --angle-unit deg"):
        read_attitude_log(path, Given(imu_axes="flu"))
    assert read_attitude_log(path, Given(imu_axes="flu", angle_unit="rad")).of_imu


def test_a_clock_that_starts_anew_is_refused(tmp_path: Path) -> None:
    samples = imu_samples(*flight(), "flu")
    samples[len(samples) // 2 :, 0] -= samples[len(samples) // 2, 0]
    with pytest.raises(InputError, match="starts anew; cut the table there"):
        read_attitude_log(write_imu(tmp_path / "imu.csv", samples), Given(imu_axes="flu"))


@pytest.mark.parametrize("factor", [0.0, 1.0])
def test_a_clock_of_whole_seconds_is_refused(tmp_path: Path, factor: float) -> None:
    samples = imu_samples(*flight(), "flu")
    samples[:, 0] = np.floor(factor * samples[:, 0])
    with pytest.raises(InputError, match="its clock stands still in most rows"):
        read_attitude_log(write_imu(tmp_path / "imu.csv", samples), Given(imu_axes="flu", time_unit="s"))


def test_a_bias_that_is_not_told_is_said(tmp_path: Path) -> None:
    for seconds, says in ((40.0, True), (80.0, False)):
        path = write_imu(tmp_path / "imu.csv", imu_samples(*flight(seconds), "flu", 50.0))
        notes = read_attitude_log(path, Given(imu_axes="flu")).notes
        assert any("bias is not known" in note for note in notes if isinstance(note, Doubt)) == says


@pytest.mark.parametrize("blank", ["0,0,0,1", "0,0,0,0"])
def test_a_driver_that_estimates_nothing_leaves_the_samples(tmp_path: Path, blank: str) -> None:
    """ROS drivers without an estimate write a quaternion that turns nothing, or zeros."""
    orientation = ",".join(f"field.orientation.{axis}" for axis in "xyzw")
    header, separator, scale = DIALECTS["ROS"]
    samples = imu_samples(*flight(), "flu") * np.repeat(scale, [1, 3, 3])
    plain = write_imu(tmp_path / "plain.csv", samples, header, separator)
    head, *rows = plain.read_text().splitlines()
    (tmp_path / "imu.csv").write_text(
        "\n".join([f"{head},{orientation}", *(f"{row},{blank}" for row in rows)])
    )
    logs = [read_attitude_log(path, Given(imu_axes="flu")) for path in (plain, tmp_path / "imu.csv")]
    np.testing.assert_array_equal(logs[0].quaternions, logs[1].quaternions)


def test_a_level_attitude_beside_the_samples_is_a_statement(tmp_path: Path) -> None:
    rows = "".join(f"{t / 50},0,0,0.1,0,0,0,0,-9.8\n" for t in range(50))
    (tmp_path / "log.csv").write_text(f"time_s,roll_deg,pitch_deg,gx,gy,gz,ax,ay,az\n{rows}")
    assert not read_attitude_log(tmp_path / "log.csv").of_imu


def test_samples_that_arrive_in_batches_are_all_used(tmp_path: Path) -> None:
    times_s, attitudes = flight(60.0)
    samples = imu_samples(times_s, attitudes, "flu", rate_hz=100.0)
    batched = np.repeat(samples[::10], 10, axis=0)
    batched[:, 0] += np.tile(np.arange(10) * 2e-5, len(batched) // 10)
    log = read_attitude_log(write_imu(tmp_path / "imu.csv", batched), Given(imu_axes="flu"))
    assert len(samples[::10]) <= len(log.times_s) < 1.2 * len(samples[::10])
    found = ups(Rotation.from_quat(np.roll(log.quaternions, -1, axis=1)))
    true = imu_samples(times_s, attitudes, "frd", rate_hz=100.0)[:, 4:] / 9.81
    true = np.stack([np.interp(log.times_s, samples[:, 0], axis) for axis in true.T], axis=-1)
    assert np.median(angles_apart_deg(found, true)) < 1.5


def test_a_blank_time_does_not_hide_that_the_clock_starts_anew(tmp_path: Path) -> None:
    samples = imu_samples(*flight(), "flu")
    middle = len(samples) // 2
    samples[middle:, 0] -= samples[middle, 0]
    samples[middle, 0] = np.nan
    with pytest.raises(InputError, match="starts anew"):
        read_attitude_log(write_imu(tmp_path / "imu.csv", samples), Given(imu_axes="flu"))


def gyroflow_log(path: Path, samples: Floats, settings: str) -> Path:
    counts = samples / np.repeat([0.001, 0.0012, 0.0005 * 9.81], [1, 3, 3])
    rows = "\n".join(",".join(f"{value:.0f}" for value in row) for row in counts.tolist())
    path.write_text(f"GYROFLOW IMU LOG\nversion,1.3\nid,made\n{settings}t,gx,gy,gz,ax,ay,az\n{rows}\n")
    return path


def test_gyroflows_log_counts_in_its_own_scales(tmp_path: Path) -> None:
    samples = imu_samples(*flight(), "flu")
    settings = "orientation,YxZ\ntscale,0.001\ngscale,0.0012\nascale,0.0005\n"
    log = read_attitude_log(gyroflow_log(tmp_path / "a.gcsv", samples, settings), Given(imu_axes="flu"))
    plain = read_attitude_log(write_imu(tmp_path / "imu.csv", samples), Given(imu_axes="flu"))
    np.testing.assert_allclose(log.times_s, plain.times_s, atol=0.001)
    first, second = (ups(Rotation.from_quat(np.roll(one.quaternions, -1, axis=1))) for one in (log, plain))
    assert angles_apart_deg(first, second).max() < 0.5
    other = read_attitude_log(tmp_path / "a.gcsv", Given(imu_axes="flu", time_unit="ms", angle_unit="deg"))
    np.testing.assert_array_equal(other.quaternions, log.quaternions)  # its own head counts
    whole = (tmp_path / "a.gcsv").read_text()
    for odd in (
        whole.replace("id,made", 'note,"never closed'),
        whole.replace("az\n", "az,\n"),
        whole.replace("id,made", "id," + "a" * 200_000),
    ):
        (tmp_path / "a.gcsv").write_text(odd)
        again = read_attitude_log(tmp_path / "a.gcsv", Given(imu_axes="flu"))
        np.testing.assert_array_equal(again.quaternions, log.quaternions)
    for bad in ("nan", "0", "inf", "1e-320", "x"):
        (tmp_path / "a.gcsv").write_text(whole.replace("tscale,0.001", f"tscale,{bad}"))
        with pytest.raises(InputError, match=r"a\.gcsv"):
            read_attitude_log(tmp_path / "a.gcsv", Given(imu_axes="flu"))
    (tmp_path / "a.gcsv").write_text(whole[: whole.index("az\n") + 3] + "1,2\n" * 9)
    with pytest.raises(InputError, match="no rows of 7 cells"):
        read_attitude_log(tmp_path / "a.gcsv", Given(imu_axes="flu"))
    for lacking in ("tscale,0.001\n", "gscale,0.0012\n"):
        path = gyroflow_log(tmp_path / "b.gcsv", samples, settings.replace(lacking, ""))
        with pytest.raises(InputError, match=r"b\.gcsv: has no usable"):
            read_attitude_log(path, Given(imu_axes="flu"))


def test_a_fast_imus_clock_counts_microseconds(tmp_path: Path) -> None:
    times_s, attitudes = flight(4.0)
    samples = imu_samples(times_s, attitudes, "flu", rate_hz=4000.0) * np.repeat([1e6, 1, 1], [1, 3, 3])
    header = HEADER.replace("time_s", "time")
    log = read_attitude_log(write_imu(tmp_path / "imu.csv", samples, header), Given(imu_axes="flu"))
    assert np.ptp(log.times_s) == pytest.approx(times_s[-1], abs=0.01)


def test_sensors_may_take_turns_in_the_rows(tmp_path: Path) -> None:
    samples = imu_samples(*flight(), "flu")
    whole = write_imu(tmp_path / "whole.csv", samples)
    head, *lines = whole.read_text().splitlines()
    cells = [line.split(",") for line in lines]
    turns = [
        [*row[:4], "", "", ""] if k % 2 else [row[0], "", "", "", *row[4:]] for k, row in enumerate(cells)
    ]
    (tmp_path / "imu.csv").write_text("\n".join([head, *(",".join(row) for row in turns)]))
    logs = [read_attitude_log(path, Given(imu_axes="flu")) for path in (whole, tmp_path / "imu.csv")]
    at = logs[0].times_s[1::2]
    np.testing.assert_allclose(logs[1].times_s, at, atol=1e-5)
    first, second = (ups(Rotation.from_quat(np.roll(log.quaternions, -1, axis=1))) for log in logs)
    assert angles_apart_deg(first[1::2], second).max() < 0.5


@pytest.fixture
def pictures_and_imu(tmp_path: Path) -> Path:
    """The embedded flight as pictures named by their time, and the table of an IMU with axes FLU."""
    recording = open_recording(embedded_set())
    table = (embedded_set() / "frames.csv").read_text().splitlines()
    columns = table[0].split(",")
    rows = [dict(zip(columns, line.split(","), strict=True)) for line in table[1:]]
    angles = np.array([[float(row[f"{name}_rad"]) for name in ("yaw", "pitch", "roll")] for row in rows])
    times_s = np.array([header.time_s for header in recording.headers])
    (tmp_path / "pictures").mkdir()
    for row, time_s in zip(rows, times_s.tolist(), strict=True):
        shutil.copy(embedded_set() / row["image"], tmp_path / "pictures" / f"{time_s:.6f}.jpg")
    shutil.copy(embedded_set() / "camera.yaml", tmp_path / "camera.yaml")
    samples = imu_samples(times_s, Rotation.from_euler("ZYX", angles), "flu")
    write_imu(tmp_path / "imu.csv", samples)
    return tmp_path


def test_check_data_finds_the_axes_in_the_pictures(pictures_and_imu: Path, capsys: Any) -> None:
    words = [str(pictures_and_imu / "pictures"), "--camera", str(pictures_and_imu / "camera.yaml")]
    words += ["--attitude", str(pictures_and_imu / "imu.csv")]
    assert main(["train", *words, "--out", str(pictures_and_imu / "run")]) == 2
    assert "--imu-axes flu" in capsys.readouterr().err
    assert not (pictures_and_imu / "run").exists()
    assert main(["check-data", *words]) == 0
    assert "'imu_axes: flu'" in capsys.readouterr().out
    with (pictures_and_imu / "camera.yaml").open("a") as file:
        file.write("imu_axes: flu\n")  # as it was told
    stated = open_recording(
        pictures_and_imu / "pictures",
        given=Given(camera=pictures_and_imu / "camera.yaml", attitude=str(pictures_and_imu / "imu.csv")),
    )
    truth = [header.up_cam for header in open_recording(embedded_set()).headers]
    found = [header.up_cam for header in stated.headers]
    pairs = [(a, b) for a, b in zip(truth, found, strict=True) if a is not None and b is not None]
    assert len(pairs) > 0.9 * len(truth)
    first, second = (np.array(side) for side in zip(*pairs, strict=True))
    assert np.median(angles_apart_deg(first, second)) < 0.5


@pytest.mark.real_data
@pytest.mark.skipif(not (DATA / "euroc_sample").is_dir(), reason="needs HORIZON_DL_DATA")
@pytest.mark.parametrize("axes", [None, "flu", "ulb"])
def test_a_camera_file_that_leads_to_the_imu_needs_no_axes(axes: str | None) -> None:
    folder = DATA / "euroc_sample" / "mav0"
    camera, imu = folder / "cam0" / "sensor.yaml", folder / "imu0" / "data.csv"
    given = Given(camera=camera, attitude=str(imu), imu_axes=axes)
    found = open_recording(folder / "cam0" / "data", "pictures", given)
    own = open_recording(DATA / "euroc_sample")
    first, second = (np.array([one.up_cam for one in each.headers]) for each in (found, own))
    assert len(first) == len(second) == 16
    if axes is None:  # the body is the camera: bearings are the camera's
        assert found.mount_rpy_rad is None
        assert any(
            "taken as the samples of the IMU that sensor.yaml leads to" in note for note in found.notes
        )
    assert angles_apart_deg(first, second).max() < 1.0  # one looks ahead in time, the other does not
