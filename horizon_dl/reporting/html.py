"""One self-contained HTML file from a list of sections; pictures travel inside it."""

from collections.abc import Sequence
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.output import write_text
from horizon_dl.reporting.sections import Heading, Section

if TYPE_CHECKING:
    from jinja2 import Template


@lru_cache
def _template() -> "Template":
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.from_string(
        files("horizon_dl.reporting").joinpath("report.html.j2").read_text("utf-8")
    )


def report_html(title: str, sections: Sequence[Section], subtitle: str = "") -> str:
    """The report as text; everything in the sections is escaped."""
    numbered: list[dict[str, Any]] = [
        {"id": f"s{n}", "section": section} for n, section in enumerate(sections)
    ]
    headings = [entry for entry in numbered if isinstance(entry["section"], Heading)]
    return _template().render(title=title, subtitle=subtitle, entries=numbered, headings=headings)


def write_report(path: Path, title: str, sections: Sequence[Section], subtitle: str = "") -> None:
    """Writes the report as one HTML file.

    Example:
        >>> sections = [Heading("Scores"), Text("One method, one figure.")]  # doctest: +SKIP
        >>> write_report(Path("out/index.html"), "Arena", sections)  # doctest: +SKIP
    """
    write_text(path, report_html(title, sections, subtitle))
