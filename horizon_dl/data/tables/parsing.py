"""Small helpers that the readers share: rows of numbers, images of a folder, times that have to meet."""

import math
import os
import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.tables import table as tables
from horizon_dl.data.tables.text import read_lines as read_lines
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

LONGEST_NAME = 255
"""Bytes; longer ones are an error of the system when they are looked for."""

LOOKED_AT = 10
"""Lines at the start of a file of numbers that may say what its columns are."""
MOST_DIGITS = 19
MOST_HEIGHT_M = 1e5
"""Nothing flies higher: a larger number is none."""
MOST_TIME_S = 1e20
"""Nanoseconds since 1970 that are taken for seconds are less."""
MOST_INERTIAL = 1e4
"""Neither turns a body so fast (rad/s), nor does an accelerometer feel so much (m/s^2)."""

IMAGE_SUFFIXES = (".jpg", ".jpeg", ".png", ".bmp", ".ppm", ".pgm", ".tif", ".tiff", ".webp")


def read_table(path: Path, required: Sequence[str]) -> list[dict[str, str]]:
    """Rows of a table of a known program, whose columns have fixed names.

    Raises:
        InputError: missing, empty, or a required column is missing (the error names it).
    """
    table = tables.read_table(path)
    require_columns(path, table.names, required)
    return [dict(zip(table.names, row, strict=True)) for row in table.rows]


def require_columns(path: Path, names: Collection[str], required: Sequence[str]) -> None:
    """InputError where a table lacks a column; it names those that are there."""
    missing = [name for name in required if name not in names]
    if missing:
        found = ", ".join(name[:30] for name in [*names][:20])
        problem = f"has no column{'s' * (len(missing) > 1)} '{', '.join(missing)}'; columns found: {found}"
        raise InputError(path, problem, f"needed are {', '.join(required)}")


def column(path: Path, rows: Sequence[Mapping[str, str]], name: str) -> Floats:
    """A column as numbers (N,), NaN for blank cells, and all of it where there is no such column.

    Raises:
        InputError: a cell holds no number; the error names row and column.
    """
    table = tables.Table(path, (name,), tuple((row.get(name, ""),) for row in rows))
    return table.numbers(name)


def read_numbers(path: Path, columns: int) -> Floats:
    """Numbers (N, columns) of a file with '#' comments, separated by commas, semicolons or blanks.

    Further columns are left out. A last line that is cut off is dropped: so ends a log when the power goes.

    Raises:
        InputError: missing, empty, or a line is too short or not numeric.
    """
    samples: list[list[float]] = []
    lines = read_lines(path)
    for place, line in enumerate(lines, 1):
        if line.lstrip().startswith("#") or (not samples and _names_columns(line)):
            continue
        try:
            row = [float(cell) for cell in _cells(line)[:columns]]
        except ValueError:
            row = []
        if len(row) < columns and place == len(lines):
            break
        if len(row) < columns:
            raise InputError(path, f"line {place} has no {columns} numbers", "correct or remove the line")
        samples.append(row)
    if not samples:
        raise InputError(path, "holds no samples", "record it again or copy it whole")
    return np.array(samples, dtype=np.float64)


def quaternion_places(path: Path, first: int, default: str) -> tuple[int, ...]:
    """Columns of w, x, y, z in a file of numbers, of which the header tells the order, if it has one.

    Args:
        path: of the file.
        first: the first of the quaternion's four columns.
        default: their order without a header, as `xyzw`.
    """
    order = default
    for line in read_lines(path)[:LOOKED_AT]:
        if not (line.lstrip().startswith("#") or _names_columns(line)):
            break
        cells = re.split(r"[,;\s]+", re.sub(r"\[[^]]*\]", "", line).strip(" #\t,;"))
        letters = "".join(cell.rstrip("_")[-1:].lower() for cell in cells[first : first + 4])
        order = letters if sorted(letters) == ["w", "x", "y", "z"] else order
    return tuple(first + order.index(one) for one in "wxyz")


def _names_columns(line: str) -> bool:
    """Whether no cell of a line holds a digit alone or a number."""
    return not any(re.match(r"[+-]?[.\d]", cell) for cell in _cells(line)) and bool(
        re.search("[A-Za-z]", line)
    )


def _cells(line: str) -> list[str]:
    """The cells of a line of numbers; commas are decimal where other signs already separate the numbers."""
    bare = line.strip().strip(",;")
    cells = re.split(r"[;\s]+", bare)
    if (
        len(cells) > 1
        and any("," in cell for cell in cells)
        and all(_DECIMAL.fullmatch(cell) for cell in cells)
    ):
        return [cell.replace(",", ".") for cell in cells]
    return re.split(r"[,;\s]+", bare)


_DECIMAL = re.compile(r"[+-]?\d*(,\d+)?(e[+-]?\d+)?", re.IGNORECASE)


def by_time(times_s: Floats, values: Floats, most: float = math.inf) -> tuple[Floats, Floats]:
    """Samples (N,) and (N, k) sorted by time; those of no time, or with a number that is none, left out.

    Args:
        times_s: s.
        values: of any unit.
        most: larger ones, of either sign, cannot be.
    """
    good = (np.abs(times_s) < MOST_TIME_S) & np.isfinite(values).all(axis=-1)
    good &= (np.abs(values) <= most).all(axis=-1)
    order = np.argsort(times_s[good], kind="stable")
    return times_s[good][order], values[good][order]


def images_in(folder: Path) -> list[Path]:
    """Image files of a folder by name, numbers in names by their value; none if there is no such folder."""
    if not folder.is_dir():
        return []
    found = (p for p in folder.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES and not p.name.startswith("."))
    return sorted(found, key=lambda path: natural(path.name))


def natural(name: str) -> list[tuple[int, str]]:
    """A key that sorts names by the values of the numbers in them.

    Example:
        >>> sorted(["f10.png", "f9.png", "f2.png"], key=natural)
        ['f2.png', 'f9.png', 'f10.png']
    """
    parts = re.split(r"(\d+)", name)
    return [(int(part), part) if part.isdecimal() else (-1, part) for part in parts]


def inside_folder(where: Path, folder: Path, name: str) -> Path:
    """The path of a file that a list names.

    Raises:
        InputError: the name leaves the folder, or is none.
    """
    parts = Path(name).parts
    if not parts or Path(name).is_absolute() or ".." in parts:
        raise InputError(where, f"names {name[:60]!r}, outside of the folder", "copy the files into it")
    if "\0" in name or len(name) > 2000 or any(len(os.fsencode(part)) > LONGEST_NAME for part in parts):
        raise InputError(where, f"names {name[:60]!r}, which is no file name", "correct the line")
    return folder / name


def whole_number(text: str) -> int | None:
    """The number in a text of at most 19 digits; None for anything else."""
    return int(text) if text.isascii() and text.isdigit() and len(text) <= MOST_DIGITS else None


def decimals(digits: str) -> float:
    """The value of the digits behind a point; ValueError for anything but digits.

    Example:
        >>> decimals("25"), decimals("")
        (0.25, 0.0)
    """
    if digits and not (digits.isascii() and digits.isdigit()):
        raise ValueError(digits)
    return float(f"0.{digits or 0}")


def usable_quaternions(quaternions: Floats) -> NDArray[np.bool_]:
    """Which of (N, 4) can be brought to length one."""
    largest = np.abs(quaternions).max(axis=-1)
    usable: NDArray[np.bool_] = (largest > 1e-6) & (largest < 1e6)
    return usable


def relative_name(path: Path, folder: Path) -> str:
    """Path relative to the recording's folder, with forward slashes on every system."""
    return path.relative_to(folder).as_posix()


def check_overlap(where: Path, image_times_s: Floats, log_times_s: Floats) -> None:
    """The images and the attitude log share some time.

    Raises:
        InputError: the times never meet; the error gives both spans.
    """
    if len(image_times_s) == 0 or len(log_times_s) == 0:
        raise InputError(where, "holds no usable samples", "check times and attitude for numbers")
    first, last = float(image_times_s.min()), float(image_times_s.max())
    start, end = float(log_times_s.min()), float(log_times_s.max())
    if last < start or first > end:
        raise InputError(
            where,
            f"covers {start:.3f} to {end:.3f} s, the images {first:.3f} to {last:.3f} s: they never meet",
            "give log and images of the same flight, on the same clock",
        )
