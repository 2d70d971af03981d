"""Gyroflow's log of a camera's IMU (`.gcsv`): a head of settings, of which three are scales, then samples.

Source: Gyroflow's documentation, "Gyroflow log format": t, g and a, times tscale, gscale and ascale, are
seconds, rad/s and multiples of gravity. The head's `orientation` is that of Gyroflow's own frame and is not
used: where the axes point in the camera is stated, or told by the pictures.
"""

import math
from pathlib import Path

from horizon_dl.data.tables.table import Table, number
from horizon_dl.data.tables.text import read_lines
from horizon_dl.errors import InputError

HEAD = b"GYROFLOW IMU LOG"
SCALES = {"t": "tscale", "g": "gscale", "a": "ascale"}
UNITS = {"t": "s", "g": "rad_s", "a": "g"}


def recognises(path: Path) -> bool:
    """Whether the file begins as such a log does."""
    try:
        with path.open("rb") as file:
            return file.read(len(HEAD)) == HEAD
    except OSError:
        return False


def read_samples(path: Path) -> Table:
    """The samples as a table whose columns name their units: `t_s`, `gx_rad_s`, ..., `az_g`.

    Raises:
        InputError: a scale or the line of names is missing, or a cell is no number.
    """
    rows = [[cell.strip() for cell in line.strip().strip(",").split(",")] for line in read_lines(path)[1:]]
    start = next((place for place, row in enumerate(rows) if row[0] == "t"), None)
    if start is None:
        raise InputError(path, "has no line t,gx,gy,gz,ax,ay,az", "export it again")
    settings = {row[0]: row[1] for row in rows[:start] if len(row) > 1}
    names = rows[start]
    scales = [_scale(path, settings, name) for name in names]
    try:
        cells = [
            tuple(repr(number(cell) * scale) for cell, scale in zip(row, scales, strict=True))
            for row in rows[start + 1 :]
            if len(row) == len(names)
        ]
    except ValueError as error:
        raise InputError(path, f"holds no samples ({str(error)[:60]})", "export it again") from None
    if not cells:
        raise InputError(path, f"holds no rows of {len(names)} cells", "export it again")
    return Table(path, tuple(f"{name}_{UNITS.get(name[:1], '')}".rstrip("_") for name in names), tuple(cells))


def _scale(path: Path, settings: dict[str, str], name: str) -> float:
    """What a column's numbers are multiplied by; 1 for columns that are not read."""
    setting = SCALES.get(name[:1])
    if setting is None:
        return 1.0
    try:
        scale = float(settings[setting])
    except (KeyError, ValueError):
        scale = math.nan
    if not 0.0 < scale < math.inf:
        raise InputError(path, f"has no usable {setting}", "export it again")
    return scale
