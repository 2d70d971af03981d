"""Images + CSV, the format to bring own data in: `frames.csv`, `camera.yaml`, images; also labels and depth.

frames.csv has the columns image, time_s, roll_rad, pitch_rad (or a quaternion qw, qx, qy, qz) and, if known,
yaw_rad and height_m. The attitude is the body's (FRD in NED); a blank or NaN attitude means that the frame
has none. A table of another name, or with other names of columns, is taken if it is the only one that fits.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.calibration.picture_size import picture_size
from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.convention import Convention, reading_with
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.source import Recording
from horizon_dl.data.tables.attitude_columns import convention_of, read_attitudes, require_attitude
from horizon_dl.data.tables.columns import Column
from horizon_dl.data.tables.find_columns import find_columns
from horizon_dl.data.tables.parsing import MOST_HEIGHT_M, relative_name
from horizon_dl.data.tables.table import Table, read_table
from horizon_dl.geometry.attitude import up_in_camera
from horizon_dl.logs.camera_and_log import camera_and_log
from horizon_dl.logs.log_recording import headers_by_log
from horizon_dl.readers.beside import files_beside
from horizon_dl.readers.frames_table import frames_table, listed_images

NAME = "images_csv"
NEEDS = "frames.csv (image,time_s,roll_rad,pitch_rad) and camera.yaml"


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return frames_table(folder) is not None


def read(folder: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens the set; --camera and --attitude count for more than what lies in the folder.

    Raises:
        InputError: a file, column or field is missing or wrong, or no frame has an attitude.
    """
    path = frames_table(folder) or folder / "frames.csv"
    folder = path.parent
    table = read_table(path)
    columns = find_columns(table)
    images, times, notes = listed_images(table, columns, given)
    calibration = read_calibration(
        given.camera or folder / "camera.yaml", size=picture_size(images), imu_axes=given.imu_axes
    )
    names = [relative_name(image, folder) for image in images]
    moved: AttitudeLog | None = None
    if given.attitude is None:
        headers, more_notes = _headers(table, columns, names, times.tolist(), calibration, given)
    else:
        calibration, log = camera_and_log(calibration, given.attitude, given)
        where = Path(given.attitude)
        headers, moved, more_notes = headers_by_log(where, names, times.tolist(), calibration, log, given)
    truths, depths = (files_beside(folder, kind, names) for kind in ("labels", "depth"))
    files = [FrameFiles(*one) for one in zip(images, truths, depths, strict=True)]
    recording = image_recording(
        folder.resolve().name,
        NAME,
        calibration.camera,
        zip(headers, files, strict=True),
        where=path,
        attitude_from=given.attitude or "the columns roll_rad and pitch_rad",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        mount_rpy_rad=calibration.known_mount,
        notes=(*calibration.notes, *notes, *more_notes),
        reading=reading_with(
            convention_of(columns) if given.attitude is None else Convention(), calibration.mount_rpy_rad
        ),
        needs_attitude=not given.find_offset,
    )
    return replace(recording, attitudes=moved)


def _headers(
    table: Table,
    columns: dict[str, Column],
    names: list[str],
    times_s: list[float],
    calibration: Calibration,
    given: Given,
) -> tuple[list[FrameHeader], tuple[str, ...]]:
    """What the table's own attitudes tell of the frames, and notes."""
    require_attitude(table, columns, "add roll_rad and pitch_rad, or a quaternion, or give --attitude LOG")
    mount = calibration.mount_rpy_rad
    rows = read_attitudes(table, columns, given)
    headers = [
        FrameHeader(
            name,
            times_s[index],
            up_in_camera(attitude, mount) if np.isfinite(attitude).all() else None,
            _known(rows.yaws_rad[index]),
            _known(rows.heights_m[index]),
            as_read=_numbers(rows.as_read, index) if np.isfinite(attitude).all() else None,
        )
        for index, (name, attitude) in enumerate(zip(names, rows.quaternions, strict=True))
    ]
    return headers, rows.notes


def _numbers(as_read: NDArray[np.float64] | None, index: int) -> tuple[float, ...] | None:
    return None if as_read is None else tuple(as_read[index].tolist())


def _known(value: float) -> float | None:
    return float(value) if abs(value) < MOST_HEIGHT_M else None
