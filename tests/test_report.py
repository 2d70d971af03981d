import base64
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from horizon_dl.inspection.finding import Finding
from horizon_dl.reporting.curves import RocLine, figure_bytes, roc_figure
from horizon_dl.reporting.html import report_html, write_report
from horizon_dl.reporting.sections import (
    GLOSSARY,
    Figure,
    Findings,
    Heading,
    Pairs,
    Section,
    Table,
    Text,
    media_type,
)
from horizon_dl.visualization.panels import image_bytes

PIXELS = np.zeros((4, 4, 3), np.uint8)


class Outline(HTMLParser):
    """Checks that tags close in order, and keeps the addresses."""

    VOID = ("meta", "img", "br")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.addresses: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def outline(page: str) -> Outline:
    parser = Outline()
    parser.feed(page)
    assert parser.open == []
    return parser


def every_section() -> list[Section]:
    line = RocLine("CNN", np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    return [
        Text("First.\n\nSecond.", lead=True),
        Heading("Scores"),
        Table(["method", "AUC"], [["CNN", "0.93"]], "A caption"),
        Heading("Pictures"),
        Figure(image_bytes(PIXELS), "one", wide=True),
        Figure(image_bytes(PIXELS, "JPEG"), "two"),
        Figure(figure_bytes(roc_figure([line])), "three"),
        Heading("Facts"),
        Findings([Finding("problem", "No horizon.", "Tilt the camera."), Finding("ok", "Light.")]),
        Pairs([("seeds", "0, 1")]),
        GLOSSARY,
    ]


def test_page_is_whole_and_needs_no_other_file() -> None:
    page = report_html("Arena", every_section(), "tail")
    found = outline(page)
    assert all(address.startswith(("data:", "#")) for address in found.addresses)
    assert not re.search(r"https?://(?!www\.w3\.org)", page)
    assert "<script" not in page


def test_pictures_travel_inside() -> None:
    page = report_html("Arena", [Figure(image_bytes(PIXELS), "one")])
    (inside,) = re.findall(r'src="data:image/png;base64,([^"]+)"', page)
    assert base64.b64decode(inside) == image_bytes(PIXELS)


def test_contents_list_links_to_the_headings() -> None:
    page = report_html("Arena", every_section())
    links = re.findall(r'href="#(\w+)"', page)
    assert links == re.findall(r'<h2 id="(\w+)"', page)
    assert len(links) == 3


def test_everything_is_escaped() -> None:
    nasty = "<script>alert(1)</script>"
    sections = [
        Text(nasty),
        Heading(nasty),
        Table([nasty], [[nasty]], nasty),
        Figure(image_bytes(PIXELS), nasty),
        Findings([Finding("ok", nasty, nasty)]),
        Pairs([(nasty, nasty)]),
    ]
    page = report_html(nasty, sections, nasty)
    assert "<script" not in page
    outline(page)


def test_figures_of_a_table_stand_to_the_right() -> None:
    page = report_html("t", [Table(["a", "b", "c"], [["x", "y", "1"]], text_columns=2)])
    assert re.findall(r'<td class="figure-cell">(\w+)</td>', page) == ["1"]
    assert re.findall(r"<td>(\w+)</td>", page) == ["x", "y"]


def test_findings_carry_their_level_and_way_out() -> None:
    page = report_html("t", [Findings([Finding("warning", "Dark.", "Add light.")])])
    assert '<span class="level warning">warning</span>' in page
    assert '<span class="way-out">Add light.</span>' in page


def test_paragraphs() -> None:
    assert re.findall(r"<p>(\w+)</p>", report_html("t", [Text("one\n\n\n\ntwo")])) == ["one", "two"]


@pytest.mark.parametrize("content", [b"", b"GIF89a", b"plain"])
def test_other_pictures_are_refused(content: bytes) -> None:
    with pytest.raises(ValueError, match="PNG, JPEG, SVG or WebP"):
        media_type(content)


def test_written_as_a_whole(tmp_path: Path) -> None:
    write_report(tmp_path / "new/index.html", "Ünïcode", [Text("±")])
    assert "Ünïcode" in (tmp_path / "new/index.html").read_text(encoding="utf-8")
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["index.html"]
