"""Images + CSV, the format to bring own data in: `frames.csv`, `camera.yaml`, images; also labels and depth.

frames.csv has the columns image, time_s, roll_rad, pitch_rad and, if known, yaw_rad and height_m. The
attitude is the body's (FRD in NED); a blank or NaN attitude means that the frame has none.
"""

import math
from collections import Counter
from pathlib import Path

from horizon_dl.data.calibration.calibration import read_calibration
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.image_folder import FrameFiles, image_recording
from horizon_dl.data.readers.parsing import MOST_HEIGHT_M, column, inside_folder, label_beside, read_table
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera

NAME = "images_csv"
NEEDS = "frames.csv (image,time_s,roll_rad,pitch_rad,...) and camera.yaml"
REQUIRED = ("image", "time_s", "roll_rad", "pitch_rad")


def recognises(folder: Path) -> bool:
    """Whether the folder looks like this format."""
    return (folder / "frames.csv").is_file()


def read(folder: Path, _: Given = NOTHING_GIVEN) -> Recording:
    """Opens the set.

    Raises:
        InputError: a file, column or field is missing or wrong, or no frame has an attitude.
    """
    table = folder / "frames.csv"
    rows = read_table(table, REQUIRED)
    calibration = read_calibration(folder / "camera.yaml")
    times = column(table, rows, "time_s")
    roll, pitch, yaw, height = (
        column(table, rows, name) for name in ("roll_rad", "pitch_rad", "yaw_rad", "height_m")
    )
    # An image that is named twice, with two times, has one label.
    stems = Counter(Path(name).stem for name in {row.get("image") or "" for row in rows})
    frames = []
    for index, row in enumerate(rows):
        if not row.get("image") or not math.isfinite(times[index]):
            raise InputError(table, f"row {index + 1} has no image or no time", "complete or remove the row")
        path = inside_folder(table, folder, row["image"])
        # The heading does not move the horizon: without it, zero serves.
        angles = (roll[index], pitch[index], yaw[index] if math.isfinite(yaw[index]) else 0.0)
        up_cam = None
        if math.isfinite(sum(angles)):
            up_cam = up_in_camera(quaternion_from_rpy(*angles), calibration.mount_rpy_rad)
        header = FrameHeader(
            name=row["image"],
            time_s=float(times[index]),
            up_cam=up_cam,
            yaw_rad=float(yaw[index]) if math.isfinite(yaw[index]) else None,
            height_m=float(height[index]) if abs(height[index]) < MOST_HEIGHT_M else None,
        )
        truth, depth = (label_beside(folder, kind, row["image"], stems) for kind in ("labels", "depth"))
        frames.append((header, FrameFiles(path, truth, depth)))
    return image_recording(
        folder.resolve().name,
        NAME,
        calibration.camera,
        frames,
        where=table,
        attitude_from="the columns roll_rad and pitch_rad",
        rotate_quarter_turns_ccw=calibration.rotate_quarter_turns_ccw,
        mount_rpy_rad=calibration.mount_rpy_rad,
    )
