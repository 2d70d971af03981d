"""A flight recorded by paparazzi: images named in microseconds since boot, and the file logger's CSV.

DATA is the flight folder or its parent: `FLIGHT/*.jpg`, `FLIGHT.csv` (beside or inside), `camera.yaml`,
`labels/`. Columns: `time` (s), `att_phi`, `att_theta`, `att_psi` (rad, NED) or the quaternion `att_qi`,
`att_qx`, `att_qy`, `att_qz`; where there, `pos_z` (m, positive down) and `cmd_thrust` tell the flight from
the ground.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.calibration.picture_size import picture_size
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.parsing import (
    check_overlap,
    column,
    images_in,
    read_lines,
    read_table,
    require_columns,
    usable_quaternions,
    whole_number,
)
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import MAX_GAP_S, interpolate, quaternion_from_rpy, up_in_camera, yaw_of
from horizon_dl.readers.beside import files_beside

Floats = NDArray[np.float64]

NAME = "paparazzi"
NEEDS = "images named in microseconds, the logger's CSV, camera.yaml"
ANGLES = ("att_phi", "att_theta", "att_psi")
QUATERNION = ("att_qi", "att_qx", "att_qy", "att_qz")
IN_FLIGHT_M = 0.3
"""Lower than this the drone takes off or lands: the camera sees the ground from too near."""


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return bool(flights_in(folder))


def flights_in(folder: Path) -> list[tuple[Path, Path]]:
    """Pairs of image folder and log: the folder itself, or those directly below."""
    places = [folder.absolute(), *(p for p in sorted(folder.glob("*")) if p.is_dir() and p.name != "labels")]
    pairs = ((place, _log_of(place)) for place in places)
    return [(place, log) for place, log in pairs if log is not None and _images(place)]


def read(folder: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens one flight; frames on the ground are left out.

    Raises:
        InputError: no flight or several, a column is missing, or log and images never meet in time.
    """
    flights = flights_in(folder)
    if not flights:
        raise InputError(folder, "holds no paparazzi flight", f"needed: {NEEDS}")
    if len(flights) > 1:
        listed = ", ".join(place.name for place, _ in flights)
        raise InputError(folder, f"holds {len(flights)} flights: {listed}", "give the folder of one of them")
    place, log = flights[0]
    images = _images(place)
    calibration = read_calibration(
        given.camera or _near(place, "camera.yaml"), size=picture_size(images), imu_axes=given.imu_axes
    )
    image_times = np.array([int(path.stem) * 1e-6 for path in images])
    times, quaternions, heights, flying = read_log(log)
    check_overlap(log, image_times, times)
    names = [f"{place.name}/{path.name}" for path in images]
    truths = files_beside(_near(place, "labels").parent, "labels", names)
    frames = []
    for path, name, truth, time_s in zip(images, names, truths, image_times.tolist(), strict=True):
        height = float(np.interp(time_s, times, heights))
        if np.interp(time_s, times, flying) < 0.5 or (math.isfinite(height) and height <= IN_FLIGHT_M):
            continue
        attitude = interpolate(times, quaternions, time_s, MAX_GAP_S)
        header = FrameHeader(
            name=name,
            time_s=time_s,
            up_cam=None if attitude is None else up_in_camera(attitude, calibration.mount_rpy_rad),
            yaw_rad=None if attitude is None else yaw_of(attitude),
            height_m=height if math.isfinite(height) else None,
            as_read=None if attitude is None else tuple(attitude.tolist()),
        )
        frames.append((header, FrameFiles(path, truth)))
    left_out = len(images) - len(frames)
    notes = [f"{left_out} of {len(images)} images left out: on the ground"] if left_out else []
    if not frames:
        raise InputError(log, f"all {left_out} images were taken on the ground", "give a log of a flight")
    return image_recording(
        place.resolve().name,
        NAME,
        calibration.camera,
        frames,
        where=log,
        attitude_from="the log",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        mount_rpy_rad=calibration.mount_rpy_rad,
        reading=reading_with(Convention(), calibration.mount_rpy_rad),
        notes=(*notes, *calibration.notes),
    )


def read_log(log: Path) -> tuple[Floats, Floats, Floats, Floats]:
    """Times (N,) s, quaternions (N, 4), heights (N,) m or NaN, and 1 or 0 (N,) for motors on or off.

    Raises:
        InputError: a column is missing or a cell is not a number.
    """
    rows = read_table(log, ("time",))
    has_quaternion = all(name in rows[0] for name in QUATERNION)
    require_columns(log, rows[0], QUATERNION if has_quaternion else ANGLES)
    times = column(log, rows, "time")
    attitude = np.stack(
        [column(log, rows, name) for name in (QUATERNION if has_quaternion else ANGLES)], axis=-1
    )
    if not has_quaternion:
        known = np.where(np.isfinite(attitude), attitude, 0.0)
        unknown = ~np.isfinite(attitude).all(axis=-1)
        attitude = np.array([quaternion_from_rpy(*angles) for angles in known])
        attitude[unknown] = np.nan
    good = np.isfinite(times) & usable_quaternions(attitude)
    # Without the column nothing speaks against flight.
    thrust = column(log, rows, "cmd_thrust") if "cmd_thrust" in rows[0] else np.ones(len(rows))
    extras = np.stack([-column(log, rows, "pos_z"), (thrust > 0).astype(np.float64)], axis=-1)
    times, joined = times[good], np.concatenate([attitude, extras], axis=-1)[good]
    order = np.argsort(times, kind="stable")
    times, joined = times[order], joined[order]
    return times, joined[:, :4], joined[:, 4], joined[:, 5]


def _images(place: Path) -> list[Path]:
    return [path for path in images_in(place) if whole_number(path.stem) is not None]


def _log_of(place: Path) -> Path | None:
    """The CSV with an attitude that belongs to a folder of images: beside it under its name, or inside it."""
    beside_it = place.parent / f"{place.name}.csv"
    candidates = [beside_it, *sorted(place.glob("*.csv"))]
    return next((path for path in candidates if path.is_file() and _has_attitude(path)), None)


def _has_attitude(path: Path) -> bool:
    """Whether a table's header is the file logger's."""
    try:
        names = {cell.strip() for cell in read_lines(path)[0].split(",")}
    except (InputError, IndexError):
        return False
    return "time" in names and not names.isdisjoint((*ANGLES, *QUATERNION))


def _near(place: Path, name: str) -> Path:
    """A file in the flight folder, else the one beside it."""
    return place / name if (place / name).exists() else place.parent / name
