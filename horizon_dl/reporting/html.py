"""One self-contained HTML file from a list of sections; pictures and the script travel inside it."""

import json
from collections.abc import Sequence
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from horizon_dl.output import write_text
from horizon_dl.reporting.browser import browser_html
from horizon_dl.reporting.chart import Chart
from horizon_dl.reporting.markup import Html, el, join
from horizon_dl.reporting.sections import (
    Browser,
    Figure,
    Findings,
    Heading,
    Links,
    Pairs,
    Section,
    Table,
    Text,
    Video,
    data_address,
)

POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "media-src 'self' file:"
)
"""What the page may load: nothing from a network."""


@lru_cache
def asset(name: str) -> Html:
    """A file of the page's own style or script."""
    return Html(files("horizon_dl.reporting").joinpath("assets", name).read_text("utf-8"))


def report_html(title: str, sections: Sequence[Section], subtitle: str = "") -> str:
    """The report as text; everything in the sections is escaped."""
    numbered = [(f"s{number}", section) for number, section in enumerate(sections)]
    headings = [(name, one.text) for name, one in numbered if isinstance(one, Heading)]
    contents = [el("a", text, href=f"#{name}") for name, text in headings] if len(headings) > 2 else []
    head = el(
        "header",
        el("h1", title),
        el("p", subtitle) if subtitle else None,
        el("nav", *contents, aria_label="Contents") if contents else None,
    )
    return "<!doctype html>\n" + el(
        "html",
        el(
            "head",
            el("meta", charset="utf-8"),
            el("meta", name="viewport", content="width=device-width, initial-scale=1"),
            el("meta", http_equiv="Content-Security-Policy", content=POLICY),
            el("title", title),
            el("style", asset("page.css")),
        ),
        el("body", el("main", head, *(_section(name, one) for name, one in numbered)), *_script(numbered)),
        lang="en",
    )


def write_report(path: Path, title: str, sections: Sequence[Section], subtitle: str = "") -> None:
    """Writes the report as one HTML file.

    Example:
        >>> sections = [Heading("Scores"), Text("One method, one figure.")]  # doctest: +SKIP
        >>> write_report(Path("out/index.html"), "Arena", sections)  # doctest: +SKIP
    """
    write_text(path, report_html(title, sections, subtitle))


def _script(sections: Sequence[tuple[str, Section]]) -> list[Html]:
    """The page's script with its data; nothing where nothing moves."""
    data: dict[str, Any] = {"charts": {}, "browser": None}
    for name, section in sections:
        if isinstance(section, Chart):
            data["charts"][section.name or name] = section.data()
        elif isinstance(section, Browser):
            data["browser"] = section.data
    if not data["charts"] and data["browser"] is None:
        return []
    # A "</script>" in a frame's name would end the element.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return [
        el("script", Html(text), type="application/json", id="data"),
        el("script", asset("page.js")),
    ]


def _section(name: str, section: Section) -> Html:
    if isinstance(section, Heading):
        return el("h2", section.text, id=name)
    if isinstance(section, Text):
        return join(*(el("p", part, class_="lead" if section.lead else None) for part in section.paragraphs))
    if isinstance(section, Table):
        return _table(section)
    if isinstance(section, Figure):
        return el(
            "figure",
            el("img", src=section.address, alt=section.alt or section.caption),
            el("figcaption", section.caption) if section.caption else None,
            class_="wide" if section.wide else None,
        )
    if isinstance(section, Findings):
        return _findings(section)
    if isinstance(section, Pairs):
        pairs = [join(el("dt", key), el("dd", value)) for key, value in section.pairs]
        return el("dl", *pairs, class_="glossary" if section.glossary else None)
    if isinstance(section, Links):
        return el("p", *(el("a", words, href=address) for address, words in section.links), class_="links")
    if isinstance(section, Video):
        return _video(section)
    if isinstance(section, Browser):
        return browser_html(section)
    return (
        section.html()
        if section.name
        else Html(section.html().replace('data-chart=""', f'data-chart="{name}"'))
    )


def _table(section: Table) -> Html:
    def cell(tag: str, column: int, text: str) -> Html:
        return el(tag, text, class_="figure-cell" if column >= section.text_columns else None)

    header = el("tr", *(cell("th", column, text) for column, text in enumerate(section.header)))
    rows = [el("tr", *(cell("td", column, text) for column, text in enumerate(row))) for row in section.rows]
    table = el(
        "table",
        el("caption", section.caption) if section.caption else None,
        el("thead", header),
        el("tbody", *rows),
    )
    label = section.caption or " ".join(section.header[:2])
    # It can be scrolled by the keyboard, too, once it has the focus.
    return el("div", table, class_="scroll", tabindex=0, role="region", aria_label=label)


def _findings(section: Findings) -> Html:
    rows = []
    for finding in section.findings:
        hint = el("span", finding.hint, class_="way-out") if finding.hint else None
        level = el("span", finding.level, class_=f"level {finding.level}")
        rows.append(el("li", level, el("span", finding.text, hint)))
    return el("ul", *rows, class_="findings")


def _video(section: Video) -> Html:
    poster = data_address(section.poster) if section.poster else None
    film = el(
        "video", src=section.path, controls=True, poster=poster, loop=True, muted=True, playsinline=True,
        preload="metadata", aria_label=section.alt,
    )  # fmt: skip
    return el(
        "figure",
        film,
        el("figcaption", f"{section.alt} ", el("a", section.path, href=section.path)),
        class_="wide film",
    )
