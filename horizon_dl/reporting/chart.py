"""Charts as small SVG that follows the page's colours; a script shows their values under the pointer."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10
from typing import Any

from horizon_dl.reporting.markup import Html, el, join

WIDTH, HEIGHT = 560, 400
LEFT, RIGHT, TOP, BOTTOM = 72, 14, 14, 50


@dataclass(frozen=True)
class Line:
    """One line of a chart.

    Attributes:
        name: in the legend.
        points: (x, y) pairs; one with a y that is None leaves a gap.
        baseline: dashed and grey: what has to be beaten.
        dots: draw the points alone.
        notes: of each point, shown with its values.
    """

    name: str
    points: Sequence[tuple[float, float | None]]
    baseline: bool = False
    dots: bool = False
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Chart:
    """Lines over two axes.

    Attributes:
        lines: to draw.
        x_label: of the lower axis.
        y_label: of the left axis.
        x_range: ends of the axis.
        y_range: ends of the axis.
        caption: what is to be seen.
        alt: the chart in a sentence, for those who do not see it.
        diagonal: draw `y = x`.
        name: by which a script finds it.
    """

    lines: Sequence[Line]
    x_label: str
    y_label: str
    x_range: tuple[float, float] = (0.0, 1.0)
    y_range: tuple[float, float] = (0.0, 1.0)
    caption: str = ""
    alt: str = ""
    diagonal: bool = False
    name: str = ""

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Where a point stands in the drawing."""
        (x0, x1), (y0, y1) = self.x_range, self.y_range
        right = LEFT + (x - x0) / ((x1 - x0) or 1.0) * (WIDTH - LEFT - RIGHT)
        down = HEIGHT - BOTTOM - (y - y0) / ((y1 - y0) or 1.0) * (HEIGHT - TOP - BOTTOM)
        return round(right, 1), round(down, 1)

    def data(self) -> dict[str, Any]:
        """What the script needs to show values."""
        series = []
        for number, line in enumerate(self.lines):
            known = [
                (*self.place(x, y), x, y, line.notes[i] if line.notes else "")
                for i, (x, y) in enumerate(line.points)
                if y is not None and isfinite(y)
            ]
            series.append({"name": line.name, "colour": _colour(line, number), "points": known})
        ends = [self.place(x, y) for x, y in zip(self.x_range, self.y_range, strict=True)]
        frame = [*ends[0], *ends[1]]
        return {"x": self.x_label, "y": self.y_label, "frame": frame, "series": series}

    def html(self) -> Html:
        """The drawing with legend and caption."""
        parts = [*self._axes()]
        if self.diagonal:
            (x0, y0), (x1, y1) = self.place(self.x_range[0], self.x_range[0]), self.place(1.0, 1.0)
            if self.x_range != (0.0, 1.0):
                x1, y1 = self.place(self.x_range[1], self.x_range[1])
            parts.append(_line(x0, y0, x1, y1, "diagonal"))
        for number, line in enumerate(self.lines):
            parts.append(self._drawn(line, _colour(line, number)))
        parts.append(Html('<g class="mark"></g>'))
        svg = el(
            "svg",
            el("title", self.alt or self.caption),
            *parts,
            viewBox=f"0 0 {WIDTH} {HEIGHT}",
            role="img",
            tabindex=0,
            aria_label=f"{self.alt or self.caption} Arrow keys read the values.",
        )
        keys = [
            el(
                "li",
                el("i", style=f"--c:var(--{_colour(one, n)})", class_="dash" if one.baseline else ""),
                one.name,
            )
            for n, one in enumerate(self.lines)
        ]
        return el(
            "figure",
            el("div", svg, el("output", "", class_="tip", aria_live="polite"), class_="plot"),
            el("ul", *keys, class_="key"),
            el("figcaption", self.caption) if self.caption else None,
            class_="chart",
            data_chart=self.name,
        )

    def _axes(self) -> list[Html]:
        parts = []
        for x in ticks(*self.x_range):
            right = self.place(x, self.y_range[0])[0]
            parts += [
                _line(right, TOP, right, HEIGHT - BOTTOM, "grid"),
                _text(right, HEIGHT - BOTTOM + 18, f"{x:.6g}", "end" if right > WIDTH - 30 else "middle"),
            ]
        for y in ticks(*self.y_range):
            down = self.place(self.x_range[0], y)[1]
            parts += [
                _line(LEFT, down, WIDTH - RIGHT, down, "grid"),
                _text(LEFT - 8, down + 4, f"{y:.6g}", "end"),
            ]
        middle = (HEIGHT - BOTTOM + TOP) / 2
        turned = f"rotate(-90 14 {middle})"
        return [
            *parts,
            _text((WIDTH + LEFT) / 2, HEIGHT - 10, self.x_label, "middle"),
            el("text", self.y_label, x=14, y=str(middle), text_anchor="middle", transform=turned),
        ]

    def _drawn(self, line: Line, colour: str) -> Html:
        places = [None if y is None or not isfinite(y) else self.place(x, y) for x, y in line.points]
        style = f"--c:var(--{colour})"
        if line.dots:
            dots = [el("circle", cx=str(p[0]), cy=str(p[1]), r="2.6") for p in places if p is not None]
            return el("g", *dots, class_="dots", style=style)
        pieces, pen = [], "M"
        for place in places:
            if place is None:
                pen = "M"
                continue
            pieces.append(f"{pen}{place[0]} {place[1]}")
            pen = "L"
        kind = "line dash" if line.baseline else "line"
        known = [p for p in places if p is not None]
        few = [el("circle", cx=str(x), cy=str(y), r="3") for x, y in known] if len(known) <= 40 else []
        return join(
            el("path", d=" ".join(pieces), class_=kind, style=style),
            el("g", *few, class_="dots", style=style) if few else None,
        )


def ticks(low: float, high: float) -> list[float]:
    """Round numbers within an interval, about five.

    Example:
        >>> ticks(1.0, 30.8)
        [5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
    """
    span = high - low
    if not span > 0:
        return [low]
    rough = span / 5
    power = 10.0 ** floor(log10(rough))
    step = power * next(factor for factor in (1, 2, 5, 10) if factor * power >= rough * 0.999)
    first = ceil(low / step - 1e-9)
    return [round(n * step, 10) for n in range(first, floor(high / step + 1e-9) + 1)]


def _colour(line: Line, number: int) -> str:
    return f"base{number % 3}" if line.baseline else f"c{number % 6}"


def _line(x0: float, y0: float, x1: float, y1: float, kind: str) -> Html:
    return el("line", x1=str(x0), y1=str(y0), x2=str(x1), y2=str(y1), class_=kind)


def _text(x: float, y: float, text: str, anchor: str) -> Html:
    return el("text", text, x=str(x), y=str(y), text_anchor=anchor)
