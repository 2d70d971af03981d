"""Gyroflow's log of a camera's IMU (`.gcsv`): a head of settings, of which three are scales, then samples.

Source: Gyroflow's documentation, "Gyroflow log format": t, g and a, times tscale, gscale and ascale, are
seconds, rad/s and multiples of gravity. The head's `orientation` is that of Gyroflow's own frame and is not
used: where the axes point in the camera is stated, or told by the pictures.
"""

import csv
from pathlib import Path

from horizon_dl.data.tables.table import Table, number
from horizon_dl.data.tables.text import read_lines
from horizon_dl.errors import InputError

HEAD = "GYROFLOW IMU LOG"
SCALES = {"t": "tscale", "g": "gscale", "a": "ascale"}
UNITS = {"t": "s", "g": "rad_s", "a": "g"}


def recognises(path: Path) -> bool:
    """Whether the file begins as such a log does."""
    return read_lines(path, len(HEAD) + 8)[:1] == [HEAD]


def read_samples(path: Path) -> Table:
    """The samples as a table whose columns name their units: `t_s`, `gx_rad_s`, ..., `az_g`.

    Raises:
        InputError: a scale or the line of names is missing, or a cell is no number.
    """
    rows = list(csv.reader(read_lines(path)[1:]))
    start = next((place for place, row in enumerate(rows) if row[0].strip() == "t"), None)
    if start is None:
        raise InputError(path, "has no line t,gx,gy,gz,ax,ay,az", "export it again")
    settings = {row[0].strip(): row[1] for row in rows[:start] if len(row) > 1}
    names = [name.strip() for name in rows[start]]
    try:
        scales = [float(settings[SCALES[name[0]]]) if name[0] in SCALES else 1.0 for name in names]
        cells = [
            tuple(repr(number(cell.strip()) * scale) for cell, scale in zip(row, scales, strict=True))
            for row in rows[start + 1 :]
            if len(row) == len(names)
        ]
    except (KeyError, ValueError, IndexError) as error:
        problem = f"has no usable scale or sample ({type(error).__name__}: {str(error)[:40]})"
        raise InputError(path, problem, "export it again") from None
    return Table(path, tuple(f"{name}_{UNITS.get(name[0], '')}".rstrip("_") for name in names), tuple(cells))
