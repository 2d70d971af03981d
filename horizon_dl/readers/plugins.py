"""Readers of other packages, by the entry points of the group `horizon_dl.readers`; see docs/READERS.md."""

import importlib.metadata
from dataclasses import dataclass, field
from typing import Any

GROUP = "horizon_dl.readers"
OFFERS = ("NAME", "NEEDS", "recognises", "read")


@dataclass(frozen=True)
class Plugins:
    """What is installed.

    Attributes:
        readers: modules (or objects) that offer what a reader does, by their NAME.
        broken: entry points that cannot be used, and why.
    """

    readers: dict[str, Any] = field(default_factory=dict)
    broken: dict[str, str] = field(default_factory=dict)


def plugins() -> Plugins:
    """All readers that installed packages offer.

    One that cannot be loaded stands in nobody's way; it is named where no reader fits, or it is asked for.
    """
    found = Plugins()
    for point in sorted(importlib.metadata.entry_points(group=GROUP), key=lambda one: one.name):
        try:
            reader = point.load()
        except Exception as error:  # anything may happen in other people's code
            found.broken[point.name] = f"{type(error).__name__}: {error}"
            continue
        missing = [name for name in OFFERS if not hasattr(reader, name)]
        if missing:
            found.broken[point.name] = f"has no {', '.join(missing)}"
        else:
            found.readers.setdefault(str(reader.NAME), reader)
    return found
