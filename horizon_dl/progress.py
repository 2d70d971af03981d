"""How far a long piece of work has come: a bar on a terminal, now and then a plain line anywhere else."""

import os
import sys
import time
from collections.abc import Iterable, Iterator
from typing import Any, Generic, Self, TypeVar

from tqdm import tqdm

T = TypeVar("T")

FIRST_LINE_S, LINE_EVERY_S = 2.0, 10.0


class Lines(Generic[T]):
    """What a bar tells, as lines of a log: after two seconds, then every ten, and at the end.

    Nothing is told of work that is done at once or never begins: its result, or its error, stands alone.

    Args:
        items: are handed through and counted; None: `update` counts.
        what: is being done.
        total: how many there are, or None.
        unit: of them, in the singular; `B` for bytes.
        initial: how many are done already.
    """

    def __init__(
        self, items: Iterable[T] | None, what: str, total: int | None, unit: str, initial: int = 0
    ) -> None:
        self._items, self._what, self._total, self._unit = items, what, total, unit
        self._done, self._figures = initial, ""
        self._told: int | None = None
        self._next_s = time.monotonic() + FIRST_LINE_S

    def __iter__(self) -> Iterator[T]:
        for item in self._items or ():
            yield item
            self.update()
        self.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def update(self, count: int = 1) -> None:
        """So many more are done."""
        self._done += count
        if time.monotonic() >= self._next_s:
            self._tell()

    def set_postfix(self, refresh: bool = True, **figures: object) -> None:
        """Figures to be told beside the count."""
        self._figures = "".join(f", {name} {value}" for name, value in figures.items())

    def close(self) -> None:
        """Tell the end, once, of what was told of before."""
        if self._told not in (None, self._done):
            self._tell()

    def _tell(self) -> None:
        self._told = self._done
        self._next_s = time.monotonic() + LINE_EVERY_S
        counts = [self._done] if self._total is None else [self._done, self._total]
        if self._unit == "B":
            counted = " of ".join(f"{count / 1e6:.1f}" for count in counts) + " MB"
        else:
            counted = " of ".join(map(str, counts)) + f" {self._unit}{'s' * (counts[-1] != 1)}"
        print(f"{self._what}: {counted}{self._figures}", file=sys.stderr, flush=True)


def show_progress(
    items: Iterable[T] | None = None,
    what: str = "",
    *,
    total: int | None = None,
    unit: str = "item",
    initial: int = 0,
    disable: bool = False,
    **more: Any,
) -> Any:
    """A bar on a terminal, lines where standard error goes into a file or a pipe.

    Args:
        items: are handed through and counted; None: the caller counts with `update`, and closes.
        what: is being done.
        total: how many there are; None: as many as `items` says.
        unit: of them, in the singular; `B` for bytes.
        initial: how many are done already.
        disable: neither; so does the variable TQDM_DISABLE.
        more: for tqdm, such as `unit_scale`.

    Returns:
        what `items` gives, with `update`, `set_postfix` and `close`: tqdm's, or `Lines`.

    Example:
        >>> sum(show_progress([1, 2, 3], "adding", disable=True))
        6
    """
    off = disable or bool(os.environ.get("TQDM_DISABLE"))
    if off or sys.stderr.isatty():
        return tqdm(items, what, total=total, unit=unit, initial=initial, disable=off, **more)
    length = getattr(items, "__len__", None)
    return Lines(items, what, total if total is not None or length is None else length(), unit, initial)
