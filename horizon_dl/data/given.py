"""What a user gives beside the data: what the data itself lacks."""

from dataclasses import dataclass
from pathlib import Path

MAVLINK, CONSTANT = "mavlink:", "constant:"
"""How attitudes begin that are no files: of an autopilot, for a camera, or one that stays."""


@dataclass(frozen=True)
class Given:
    """Options that mean the same in every verb; None: the data has it, or nobody does.

    Attributes:
        camera: a calibration file, `--camera`.
        attitude: `--attitude`: a log, `constant:ROLL,PITCH` in degrees, `from-images`, or `mavlink:URL`.
        time_offset_s: `--time-offset`: is added to the times of the log to give those of the images.
        imu_axes: `--imu-axes`: of the IMU that a calibration file leads to, or whose samples are the
            attitude, as flu; see `geometry.axes`.
        convention: `--convention`: how the attitude's numbers are to be read, see `data.convention`.
        needs_attitude: a recording without any attitude is refused.
        time_unit: `--time-unit`: s, ms, us or ns, of the clock in a table.
        angle_unit: `--angle-unit`: rad or deg, of the angles, or rates, in a table.
        topics: of a bag, `--topic`: which of several are meant.
        time_drift_ppm: by how much the images' clock is faster than the log's, millionths.
        find_offset: `--time-offset auto`: offset and drift are found from the pictures.
    """

    camera: Path | None = None
    attitude: str | None = None
    time_offset_s: float = 0.0
    needs_attitude: bool = True
    imu_axes: str | None = None
    convention: str | None = None
    time_unit: str | None = None
    angle_unit: str | None = None
    topics: tuple[str, ...] = ()
    time_drift_ppm: float = 0.0
    find_offset: bool = False


NOTHING_GIVEN = Given()
