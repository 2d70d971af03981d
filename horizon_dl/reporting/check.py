"""A check of data on the console and as a folder: JSON, horizon overlays and a page."""

import textwrap
from pathlib import Path

import numpy as np

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.view import View
from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.output.files import without_nan, write_json
from horizon_dl.reporting.html import write_report
from horizon_dl.reporting.sections import Figure, Findings, Heading, Pairs, Section, Text
from horizon_dl.visualization.cells import resize_image, resize_map
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.overlays import draw_sides
from horizon_dl.visualization.panels import image_bytes, save_panel

LINE_WIDTH = 100
OVERLAY_WIDTH = 640


def check_lines(check: DataCheck) -> list[str]:
    """The check for the console: verdict, then the findings, their hints indented underneath."""
    lines = [f"{check.name} ({check.format})", *textwrap.wrap(check.verdict, LINE_WIDTH), ""]
    for finding in check.findings:
        lines += _wrapped(f"{finding.level:<9}", finding.text)
        if finding.hint:
            lines += _wrapped(" " * 9 + "-> ", finding.hint)
    return lines


def _wrapped(lead: str, text: str) -> list[str]:
    return textwrap.wrap(text, LINE_WIDTH, initial_indent=lead, subsequent_indent=" " * len(lead))


def overlay(view: View, band_rad: float, width: int = OVERLAY_WIDTH) -> Image:
    """The view enlarged, blue above and green below the horizon, with the ignored band's edges."""
    height = round(view.image.shape[0] * width / view.image.shape[1])
    elevation = resize_map(view.elevation, width, height)
    return draw_sides(resize_image(view.image, width, height), elevation, band_rad)


def write_check(check: DataCheck, out: Path) -> None:
    """Writes `check.json`, `overlays/*.jpg` and `index.html` into a folder."""
    band_rad = float(np.deg2rad(check.band_deg))
    pictures = [(header, overlay(view, band_rad)) for header, view in check.overlay_views]
    write_json(out / "check.json", without_nan({"schema": 1, **check.to_json()}))
    for number, (header, picture) in enumerate(pictures):
        save_panel(out / "overlays" / f"{number:02d}_{Path(header.name).stem}.jpg", picture)
    write_report(out / "index.html", f"Check of {check.name}", _sections(check, pictures), _subtitle(check))


def _subtitle(check: DataCheck) -> str:
    return f"{check.frames} frames, format {check.format}; {check.sampled} images looked at"


def _sections(check: DataCheck, pictures: list[tuple[FrameHeader, Image]]) -> list[Section]:
    sections: list[Section] = [
        Text(check.verdict, lead=True),
        Heading("Findings"),
        Findings(check.findings),
    ]
    if pictures:
        sections += [
            Heading("Horizon"),
            Text(
                "Blue lies above the horizon, green below; between the white lines nothing is learned. The "
                "yellow line should pass through the points where level lines of the floor and the walls "
                "meet. If it misses them in every picture, the mount is wrong; if in some, the clock."
            ),
            *(
                Figure(image_bytes(picture, "JPEG"), f"{header.name}, {header.time_s:.2f} s")
                for header, picture in pictures
            ),
        ]
    if check.unreadable_examples:
        sections += [Heading("Images that cannot be read"), Pairs(check.unreadable_examples)]
    return sections
