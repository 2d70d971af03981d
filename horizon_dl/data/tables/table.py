"""Reads a table with a header, whatever separates its columns and its decimals."""

import csv
import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.tables.text import read_lines
from horizon_dl.errors import InputError

Floats = NDArray[np.float64]

SEPARATORS = ("\t", ";", "|", ",")
COMMENTS = ("#", "%", "//")
NOTHING = {"", "-", "--", "--.--", "na", "n/a", "none", "null", "nan", "#n/a"}
LOOKED_AT = 50
MOST_BEFORE = 500
"""Lines before the one that names the columns."""


@dataclass(frozen=True)
class Table:
    """The cells of a table as text, stripped; a cell that a row lacks is blank.

    Attributes:
        path: of the file, for errors.
        names: of the columns, as written.
        rows: each as long as `names`.
    """

    path: Path
    names: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def texts(self, name: str) -> list[str]:
        """A column as it is written."""
        place = self.names.index(name)
        return [row[place] for row in self.rows]

    def numbers(self, name: str, hint: str = "write a number or leave it blank") -> Floats:
        """A column as numbers (N,), NaN for blank cells.

        Args:
            name: of the column.
            hint: the way out where a cell holds something else.

        Raises:
            InputError: a cell holds no number; the error names row and column.
        """
        texts = self.texts(name)
        try:
            return np.array([float(cell) for cell in texts])
        except ValueError:  # blank cells, words for nothing, decimal commas
            values = np.full(len(self.rows), np.nan)
        for index, cell in enumerate(texts):
            try:
                values[index] = number(cell)
            except ValueError:
                problem = f"row {index + 1}, column '{name}' holds {cell[:40]!r}"
                raise InputError(self.path, problem, hint) from None
        return values

    @property
    def found(self) -> str:
        """The names of the columns, for an error."""
        shown = ", ".join(name[:30] for name in self.names[:20])
        return f"columns found: {shown}{', ...' * (len(self.names) > 20)}"


def number(cell: str) -> float:
    """The number in a cell, with a decimal point or comma; NaN where the cell is blank or says so.

    Raises:
        ValueError: it is something else.

    Example:
        >>> number("1,5"), number("-2e-3"), number("n/a")
        (1.5, -0.002, nan)
    """
    try:
        return float(cell)
    except ValueError:
        if cell.lower() in NOTHING:
            return math.nan
        if re.fullmatch(r"[+-]?\d*,\d*(e[+-]?\d+)?", cell, re.IGNORECASE):
            return float(cell.replace(",", "."))
        raise


def read_table(path: Path, head_bytes: int | None = None) -> Table:
    """The table in a text file; the first line that is no comment names its columns.

    Lines that a device writes before that line, of other widths than the rows', are passed over.

    Args:
        path: of the file.
        head_bytes: read no more than the rows in so many bytes.

    Raises:
        InputError: missing, not text, without rows, or its columns cannot be told apart.
    """
    try:
        names, rows = _names_and_rows(read_lines(path, head_bytes))
    except csv.Error:
        raise InputError(path, "is not a CSV file", "separate columns with commas") from None
    if not rows:
        raise InputError(path, "has no rows", "give a header line and one line for each sample")
    if any(_is_number(name) for name in names):
        raise InputError(path, "has no line that names its columns", "add one, as time_s,roll_rad,pitch_rad")
    longest = max(len(_without_blank_end(row)) for row in rows)
    if longest > len(names):
        problem = f"has rows of {longest} cells under a header of {len(names)}"
        raise InputError(path, problem, "name every column; separate decimal commas with semicolons")
    width = len(names)
    _drop_cut_off(rows)
    return Table(path, tuple(names), tuple(tuple([*row, *[""] * width][:width]) for row in rows))


def _names_and_rows(lines: list[str]) -> tuple[list[str], list[list[str]]]:
    """The cells of the line that names the columns, and of those below it; none where there are too few.

    Raises:
        csv.Error: a cell is longer than any.
    """
    separator = None
    if lines and re.fullmatch(r'"?sep=(.)"?', lines[0].strip()):  # as Excel writes it
        separator = lines[0].strip().strip('"')[-1]
        lines = lines[1:]
    comments = [line for line in lines if line.lstrip().startswith(COMMENTS)]
    body = [line for line in lines if not line.lstrip().startswith(COMMENTS)]
    if len(body) + bool(comments) < 2:
        return [], []
    body = body[_header_line(body) :]
    separator = separator or find_separator(body[:LOOKED_AT])
    if comments and any(_is_number(cell) for cell in _cells(body[0], separator)):
        body.insert(0, comments[-1].lstrip().lstrip("#%/"))
    names, *rows = (_cells(line, separator) for line in body)
    while len(names) > 1 and not names[-1]:  # a separator at the end of each line
        names.pop()
    if len(rows) > 1 and len(rows[0]) == len(names) and all(map(_is_unit, rows[0])):
        return [f"{name} {unit}" for name, unit in zip(names, rows.pop(0), strict=True)], rows
    return names, rows


def _is_unit(cell: str) -> bool:
    """Whether a cell of the line below the names is a unit, as `(deg)` or `[m/s]`."""
    return bool(re.fullmatch(r"\(.*\)|\[.*\]", cell))


def _header_line(lines: Sequence[str]) -> int:
    """The place of the line that names the columns: what a device says of itself may stand before it."""
    tail = lines[-LOOKED_AT:]
    separator = find_separator(tail)
    width = Counter(len(_without_blank_end(_cells(line, separator))) for line in tail).most_common(1)[0][0]
    for place, line in enumerate(lines[:MOST_BEFORE]):
        cells = _without_blank_end(_cells(line, separator))
        if len(cells) == width:
            return place if width > 1 and all(map(_may_name, cells)) else 0
        if len(cells) > 1 and all(map(_is_number, cells)):  # of another table
            return 0
    return 0


def _may_name(cell: str) -> bool:
    """Whether a cell may be the name of a column: no number, date or word for nothing."""
    return cell.lower() not in NOTHING and not cell[0].isdigit() and not _is_number(cell)


def find_separator(lines: Sequence[str]) -> str:
    r"""What separates the cells: the sign that gives the most lines as many cells as the first one.

    Example:
        >>> find_separator(["a;b", "1,0;2,0"]), find_separator(["a b", "1 2"])
        (';', ' ')
    """

    def fitting(separator: str) -> tuple[float, int]:
        widths = [len(_without_blank_end(_cells(line, separator))) for line in lines]
        same = sum(width == widths[0] for width in widths) / len(widths)
        return (same if widths[0] > 1 else 0.0, widths[0])

    best = max((*SEPARATORS, " "), key=lambda separator: fitting(separator)[0])
    # Rows are often cut short, but not most of them.
    return best if fitting(best)[0] > 0.5 else max(SEPARATORS, key=lambda one: lines[0].count(one))


def _drop_cut_off(rows: list[list[str]]) -> None:
    """Blanks the last cell of a last row that was cut off: what is left of it is another number."""
    if len(rows) < 3 or not rows[-1]:
        return
    last, others = rows[-1], rows[-LOOKED_AT:-1]
    place = len(last) - 1
    cells = [row[place] for row in others if len(row) > place]
    shorter_row = all(len(row) > len(last) for row in others)
    shorter_cell = bool(cells) and any(size(last[place]) < min(map(size, cells)) for size in (len, _decimals))
    if shorter_row or shorter_cell:
        last[place] = ""


def _decimals(cell: str) -> int:
    return len(re.split(r"[.,]", cell, maxsplit=1)[-1]) if re.search(r"[.,]", cell) else 0


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    # A line at a time: a quote that is never closed would swallow all that follow.
    quoted = '"' in line
    cells = (
        next(csv.reader([line], delimiter=separator, skipinitialspace=True))
        if quoted
        else line.split(separator)
    )
    return [cell.strip() for cell in cells]


def _without_blank_end(row: Sequence[str]) -> list[str]:
    cells = list(row)
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(number(cell))
    except ValueError:
        return False
