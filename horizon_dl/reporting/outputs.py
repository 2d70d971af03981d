"""The sinks that every run ends with: a film and a page."""

from collections.abc import Callable, Sequence
from pathlib import Path

from horizon_dl.data.source import FrameSource
from horizon_dl.reporting.run_page import FILM, Page
from horizon_dl.visualization.film import Film
from horizon_dl.visualization.sink import Sink

NO_FILM = "no film: it needs av; pip install 'horizon-dl[logs]'"


def film_and_page(
    folder: Path,
    source: FrameSource,
    title: str,
    lead: Callable[[Page], str],
    facts: Callable[[], Sequence[tuple[str, str]]] = tuple,
    film: str = FILM,
) -> list[Sink]:
    """A film, where it can be encoded and there is more than a picture, and a page, in this order."""
    shown = None
    if source.length != 1 and can_film():
        # The times of plain pictures are those of their files: no pace to show them at.
        shown = Film(folder / film, source.camera is not None, timed=source.camera is not None)
    page = Page(folder, title, lead, facts, shown)
    return [page] if shown is None else [shown, page]


def can_film() -> bool:
    """Whether PyAV is there."""
    from importlib.util import find_spec

    return find_spec("av") is not None
