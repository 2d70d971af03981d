"""What a report is made of: headings, texts, tables, figures, findings and facts."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from horizon_dl.inspection.finding import Finding
from horizon_dl.reporting.chart import Chart


def media_type(content: bytes) -> str:
    """Media type of a picture from its first bytes.

    Raises:
        ValueError: neither PNG, JPEG, SVG nor WebP.
    """
    if content.startswith(b"\x89PNG"):
        return "image/png"
    if content.startswith(b"\xff\xd8"):
        return "image/jpeg"
    if b"<svg" in content[:2000]:
        return "image/svg+xml"
    if content[:4] == b"RIFF" and content[8:12] == b"WEBP":
        return "image/webp"
    raise ValueError("a figure needs the bytes of a PNG, JPEG, SVG or WebP file")


def data_address(content: bytes) -> str:
    """A picture as an address, so that a page is one file."""
    return f"data:{media_type(content)};base64,{base64.b64encode(content).decode('ascii')}"


@dataclass(frozen=True)
class Heading:
    """A heading that the contents list links to."""

    text: str


@dataclass(frozen=True)
class Text:
    """Plain text; blank lines separate paragraphs. `lead` sets it larger."""

    text: str
    lead: bool = False

    @property
    def paragraphs(self) -> list[str]:
        """The text's paragraphs."""
        return [part.strip() for part in self.text.split("\n\n") if part.strip()]


@dataclass(frozen=True)
class Table:
    """Rows under a header; the first `text_columns` columns are text, the rest figures, set to the right."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    text_columns: int = 1


@dataclass(frozen=True)
class Figure:
    """A picture: the bytes of a PNG, JPEG or SVG file. `wide` lets it use the whole page."""

    content: bytes
    caption: str = ""
    alt: str = ""
    wide: bool = False

    @property
    def address(self) -> str:
        """The picture as a data address, so that the report is one file."""
        return data_address(self.content)


@dataclass(frozen=True)
class Findings:
    """A list of findings; the first section of `check-data`."""

    findings: Sequence[Finding]


@dataclass(frozen=True)
class Pairs:
    """Short facts as name and value, such as protocol, seeds, machine and versions; also a glossary."""

    pairs: Sequence[tuple[str, str]]
    glossary: bool = False


@dataclass(frozen=True)
class Video:
    """A film that lies beside the page; a page that was sent without it says so."""

    path: str
    alt: str
    poster: bytes = b""


@dataclass(frozen=True)
class Links:
    """Files beside the page: address and words."""

    links: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Browser:
    """Frames to go through, with a threshold that moves their obstacle maps; `data` is of `stills`.

    Attributes:
        data: what the script shows.
        facts: whether there is a truth, so that frames can be sorted by how badly they did.
    """

    data: Mapping[str, Any]
    facts: bool = False


Section = Heading | Text | Table | Figure | Findings | Pairs | Video | Links | Browser | Chart

GLOSSARY = Pairs(
    (
        ("horizon label", "1 above, 0 below the horizon that the attitude gives; free for every image."),
        ("p_above", "Probability that a pixel looks like what is found above the horizon."),
        (
            "entropy",
            "The paper's score, in bits: 0 sure, 1 undecided. What stands on both sides of the horizon, as "
            "obstacles do, scores high. Its map over the paper's threshold is shown to compare, not flown.",
        ),
        (
            "surprisal",
            "The score that is flown: how surprising a pixel's appearance is on the side where it really "
            "lies, in bits; drawn as the probability of the other side.",
        ),
        (
            "what is flown",
            "Along each bearing, from the nearest ground up: free until the surprisal rises over the floor's "
            "level and stays there, blocked from there on; unknown where evidence lacks, with the reason.",
        ),
        (
            "distance per bearing",
            "Metres along a flat floor to the first obstacle of each direction, from the camera's height: "
            "contacts from red (near) to yellow (far), free ground green, unknown grey and hatched, the free "
            "heading nearest to straight ahead blue.",
        ),
        ("mutual information", "The part of the entropy that more training could remove: novelty."),
        (
            "AUC",
            "Chance that an obstacle pixel scores above a floor pixel, pooled over all labelled pixels below "
            "the horizon of all test frames.",
        ),
        (
            "AUC within depression",
            "The same among pixels equally far below the horizon: what appearance adds to position. "
            "Position alone gets 0.5.",
        ),
        (
            "AP, FPR95, best F1",
            "Average precision; share of the floor called obstacle where 95 % of the obstacles are found; "
            "the best balance of precision and recall.",
        ),
        (
            "position, guided diffusion, geodesic",
            "Baselines that learn nothing; a learned score has to beat them.",
        ),
        ("±", "Standard deviation over the seeds."),
    ),
    glossary=True,
)
