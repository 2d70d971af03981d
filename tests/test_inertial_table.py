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


@pytest.mark.parametrize(
    ("header", "rates", "forces"),
    [
        ("t,ax,ay,az,gx,gy,gz", "gx", "ax"),
        ("time,gFx,gFy,gFz,wx,wy,wz", "wx", "gFx"),
        ("t,x_gyro,y_gyro,z_gyro,x_acc,y_acc,z_acc,x_mag,y_mag,z_mag", "x_gyro", "x_acc"),
        ("t,userAccelerationX,userAccelerationY,userAccelerationZ,accelX,accelY,accelZ,gyroX,gyroY,gyroZ",
         "gyroX", "accelX"),
        ("linear acceleration x,linear acceleration y,linear acceleration z,accelerometer x,accelerometer y,"
         "accelerometer z,gyroscope x,gyroscope y,gyroscope z", "gyroscope x", "accelerometer x"),
        ("t,acc_x,acc_y,gyro_x,gyro_y,gyro_z", None, None),
        ("t,mag_x,mag_y,mag_z,acc_x,acc_y,acc_z", None, None),
        ("t,roll,pitch,max,relax,axis,proxy,topaz", None, None),
    ],
)  # fmt: skip
def test_columns_by_their_names(header: str, rates: str | None, forces: str | None) -> None:
    found = inertial_columns(header.split(","))
    assert (rates, forces) == (None, None) if found is None else (found.rates[0], found.forces[0])
    if found is not None:
        assert (found.rates[0], found.forces[0]) == (rates, forces)


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


@pytest.mark.parametrize(
    ("scale", "header", "says"),
    [
        ((1, 1, 1), HEADER.replace("_rad_s", ""), "the rates have no unit; --angle-unit rad or"),
        ((1, 1, 0.03), HEADER, "neither 9.8 m/s"),
        ((1, 1, 0), HEADER, "neither 9.8 m/s"),
        ((0, 1, 1), HEADER, "imu.csv"),
        ((1, float("nan"), 1), HEADER, "under 10 samples"),
    ],
)
def test_what_is_not_certain_is_one_line(
    tmp_path: Path, scale: tuple[float, ...], header: str, says: str
) -> None:
    samples = imu_samples(*flight(5.0), "flu") * np.repeat(scale, [1, 3, 3])
    path = write_imu(tmp_path / "imu.csv", samples, header)
    if scale[0]:
        with pytest.raises(InputError, match=says):
            read_attitude_log(path, Given(imu_axes="flu"))
    else:  # a clock that stands: no attitude is made up, and nothing breaks
        assert np.isfinite(read_attitude_log(path, Given(imu_axes="flu")).quaternions).all()


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
    assert angles_apart_deg(first, second).max() < 1.0  # one looks ahead in time, the other does not
