"""Small helpers that the readers share: tables, images of a folder, labels beside them."""

import csv
import math
import os
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.regular_file import read_regular
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

LONGEST_NAME = 255
"""Bytes; longer ones are an error of the system when they are looked for."""
MOST_DIGITS = 19
MOST_HEIGHT_M = 1e5
"""Nothing flies higher: a larger number is none."""

IMAGE_SUFFIXES = (".jpg", ".jpeg", ".png", ".bmp", ".ppm", ".pgm", ".tif", ".tiff", ".webp")
MAX_GAP_S = 0.2
"""Longest gap between two attitude samples that is bridged; robots turn too much in longer ones."""


def read_lines(path: Path) -> list[str]:
    """Lines of a text file without blank ones.

    Raises:
        InputError: missing or not text.
    """
    try:
        text = read_regular(path)
    except FileNotFoundError:
        raise InputError(path, "is missing", "restore the file") from None
    return [line for line in text.splitlines() if line.strip()]


def read_table(path: Path, required: Sequence[str]) -> list[dict[str, str]]:
    """Rows of a CSV file with a header; names and values stripped.

    Raises:
        InputError: missing, empty, or a required column is missing (the error names it).
    """
    lines = read_lines(path)
    if len(lines) < 2:
        raise InputError(path, "has no rows", "give a header line and one line for each sample")
    try:
        rows = list(csv.reader(lines))
    except csv.Error:
        raise InputError(path, "is not a CSV file", "separate columns with commas") from None
    header = [name.strip() for name in rows[0]]
    missing = [name for name in required if name not in header]
    if missing:
        plural = "s" if len(missing) > 1 else ""
        raise InputError(
            path, f"has no column{plural} '{', '.join(missing)}'", f"needed are {', '.join(required)}"
        )
    return [dict(zip(header, (value.strip() for value in row), strict=False)) for row in rows[1:]]


def number(text: str | None) -> float:
    """The number in a cell, NaN where it is blank or says so.

    Raises:
        ValueError: it is something else.
    """
    return float(text) if text else math.nan


def column(path: Path, rows: Sequence[Mapping[str, str]], name: str) -> Floats:
    """A column as numbers (N,), NaN for blank cells.

    Raises:
        InputError: a cell holds no number; the error names line and column.
    """
    values = np.full(len(rows), np.nan)
    for index, row in enumerate(rows):
        try:
            values[index] = number(row.get(name))
        except ValueError:
            cell = str(row.get(name))[:40]
            raise InputError(
                path, f"row {index + 1}, column '{name}' holds {cell!r}", "write a number or leave it blank"
            ) from None
    return values


def read_numbers(path: Path, columns: int) -> Floats:
    """Numbers (N, columns) of a file with '#' comments, separated by commas or blanks.

    Further columns are left out. A last line that is cut off is dropped: so ends a log when the power goes.

    Raises:
        InputError: missing, empty, or a line is too short or not numeric.
    """
    samples: list[list[float]] = []
    lines = read_lines(path)
    for place, line in enumerate(lines, 1):
        if line.lstrip().startswith("#"):
            continue
        try:
            row = [float(cell) for cell in re.split(r"[,\s]+", line.strip().strip(","))[:columns]]
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


def by_time(times_s: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Samples (N,) and (N, k) sorted by time; those with a NaN or infinite number in them left out."""
    good = np.isfinite(times_s) & np.isfinite(values).all(axis=-1)
    order = np.argsort(times_s[good], kind="stable")
    return times_s[good][order], values[good][order]


def images_in(folder: Path) -> list[Path]:
    """Image files of a folder, sorted by name; none if there is no such folder."""
    if not folder.is_dir():
        return []
    return sorted(
        p for p in folder.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES and not p.name.startswith(".")
    )


def beside(folder: Path, kind: str, stem: str) -> Path | None:
    """`folder/kind/stem.png` if it is there."""
    path = folder / kind / f"{stem}.png"
    return path if len(os.fsencode(path.name)) <= LONGEST_NAME and path.is_file() else None


def label_beside(folder: Path, kind: str, name: str, stems: Counter[str]) -> Path | None:
    """The `kind` image (`labels`, `depth`) of an image by its name within the recording.

    `kind/a/1.png` belongs to `a/1.jpg` and to `images/a/1.jpg`; `kind/1.png` does as well where no other
    image of the recording has that stem.

    Args:
        folder: of the recording.
        kind: name of the folder with the labels.
        name: of the image, relative to `folder`.
        stems: how many images have each stem.
    """
    path = Path(name).with_suffix("")
    parts = path.parts
    whole = [beside(folder, kind, "/".join(parts[start:])) for start in range(min(2, len(parts) - 1))]
    alone = beside(folder, kind, path.name) if stems[path.name] < 2 else None
    return next((found for found in (*whole, alone) if found), None)


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
