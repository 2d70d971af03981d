"""Typed access to a file's fields, with an error that names file and field."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from horizon_dl.calibration.limits import MAX_NUMBERS, MAX_SIDE_PX, shown
from horizon_dl.errors import InputError

Tree = Mapping[str, Any]


@dataclass(frozen=True)
class Fields:
    """The fields of a file, or of a section of it.

    Attributes:
        path: the file.
        content: names and values.
        prefix: what stands before a name in messages, as `cam0.`.
    """

    path: Path
    content: Tree
    prefix: str = ""

    def get(self, name: str) -> Any:
        """The field's value; InputError where it is missing."""
        if self.content.get(name) is None:
            raise InputError(
                self.path, f"has no field '{self.prefix}{name}'", "add it, see README, data formats"
            )
        return self.content[name]

    def has(self, name: str) -> bool:
        """Whether the field is there and holds something."""
        return self.content.get(name) is not None

    def first(self, names: Sequence[str]) -> str:
        """The name under which a field is there, else the first, whose absence is then reported."""
        return next((name for name in names if self.has(name)), names[0])

    def section(self, name: str) -> "Fields":
        """The fields inside a field; InputError where it holds none."""
        value = self.get(name)
        if not isinstance(value, Mapping):
            raise self.wrong(name, "a section with fields of its own")
        return Fields(self.path, value, f"{self.prefix}{name}.")

    def wrong(self, name: str, need: str) -> InputError:
        """The error for a field with an unusable value."""
        value = shown(self.content.get(name))
        return InputError(self.path, f"field '{self.prefix}{name}' is {value}", f"give {need}")

    def text(self, name: str) -> str:
        """A short text; '' where the field is missing."""
        value = self.content.get(name)
        return "" if isinstance(value, Mapping | list) or value is None else str(value).strip()[:80]

    def number(self, name: str) -> float:
        """A finite number."""
        return self._numbers(name, [self.get(name)], "a number")[0]

    def size(self, name: str) -> int:
        """A positive whole number of pixels."""
        return self._pixels(name, self.number(name))

    def sizes(self, name: str) -> tuple[int, int]:
        """Width and height, pixels."""
        width, height = self.numbers(name, 2)
        return self._pixels(name, width), self._pixels(name, height)

    def numbers(self, name: str, count: int | None = None) -> tuple[float, ...]:
        """Finite numbers, `count` of them if given: a list, rows, or a matrix as OpenCV and ROS store it."""
        value = self.get(name)
        if isinstance(value, Mapping):  # OpenCV, ROS: rows, cols, data
            value = Fields(self.path, value, f"{self.prefix}{name}.").get("data")
        need = "a list of numbers" if count is None else f"{count} numbers"
        if not isinstance(value, Sequence) or isinstance(value, str | bytes) or len(value) > MAX_NUMBERS:
            raise self.wrong(name, need)
        if any(isinstance(row, Sequence) and not isinstance(row, str | bytes) for row in value):
            rows = [row if isinstance(row, list) else [row] for row in value]
            if sum(map(len, rows)) > MAX_NUMBERS:
                raise self.wrong(name, need)
            value = [number for row in rows for number in row]
        if count not in (None, len(value)):
            raise self.wrong(name, need)
        return self._numbers(name, value, need)

    def _pixels(self, name: str, value: float) -> int:
        if value != int(value) or not 1 <= value <= MAX_SIDE_PX:
            raise self.wrong(name, f"whole pixels from 1 to {MAX_SIDE_PX}")
        return int(value)

    def _numbers(self, name: str, values: Sequence[Any], need: str) -> tuple[float, ...]:
        try:
            if any(isinstance(value, Mapping | list) for value in values):
                raise TypeError
            numbers = tuple(float(value) for value in values)
        except (TypeError, ValueError, OverflowError):
            raise self.wrong(name, need) from None
        if not all(map(math.isfinite, numbers)):
            raise self.wrong(name, f"{need}, all finite")
        return numbers
