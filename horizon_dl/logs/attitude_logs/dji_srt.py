"""DJI's subtitles (.SRT): one block a frame; few cameras write the gimbal's attitude into them."""

import re
from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, log_of_angles
from horizon_dl.data.tables.parsing import read_lines
from horizon_dl.errors import InputError

NAME = "srt"
NEEDS = "DJI's subtitles with the gimbal's angles (gb_yaw, gb_pitch, gb_roll), .SRT"

SPAN = re.compile(r"(?<!\d)(\d{1,6}):(\d\d):(\d\d)[,.](\d{3})\s*-->")
ANGLE = re.compile(r"\b(gb_roll|gb_pitch|gb_yaw)\s*:\s*(-?\d+(?:\.\d+)?)")
WITH_ATTITUDE = "of the cameras known, the Avata 360 writes it"
STABILISED = re.compile(r"pp_current\s*:\s*(?!0\.000, 0\.000, 0\.000, 0\.000)")


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file is subtitles."""
    return SPAN.search(head[:2000].decode("utf-8", "replace")) is not None


def read(path: Path) -> AttitudeLog:
    """The gimbal's angles, which are the camera's own against the world; seconds since the film began.

    Raises:
        InputError: the dialect has no attitude; the error says what there is.
    """
    rows: list[list[float]] = []
    stabilised = False
    for line in read_lines(path):
        if span := SPAN.search(line):
            hours, minutes, seconds, milliseconds = (int(part) for part in span.groups())
            time_s = hours * 3600 + minutes * 60 + seconds + milliseconds / 1000
            rows.append([time_s, np.nan, np.nan, np.nan])
        elif rows:
            for name, value in ANGLE.findall(line):
                rows[-1][("gb_roll", "gb_pitch", "gb_yaw").index(name) + 1] = float(value)
            stabilised |= STABILISED.search(line) is not None
    table = np.array(rows, np.float64).reshape(-1, 4)
    log = log_of_angles(table[:, 0], np.deg2rad(table[:, 1:]))
    if not len(log.times_s):
        also = "; its pp_current is the stabilisation, no attitude" if stabilised else ""
        raise InputError(
            path,
            f"has subtitles without a gimbal's attitude ({WITH_ATTITUDE}){also}",
            "give the flight log as CSV, or --attitude constant:ROLL,PITCH for a gimbal that was not moved",
        )
    return log
