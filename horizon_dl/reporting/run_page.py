"""A sink that ends as a page: what a run has seen, frame by frame."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from horizon_dl.data.frame import Frame
from horizon_dl.reporting.browser_data import Slider, browser_data
from horizon_dl.reporting.chart import Chart, Line
from horizon_dl.reporting.html import write_report
from horizon_dl.reporting.sections import Browser, Heading, Links, Pairs, Section, Text, Video
from horizon_dl.reporting.stills import Still, Stills, auc_of, said_of, still
from horizon_dl.runtime.prediction import PAPER_SCORE, Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.film import Film

LEARNER = "model"
FILM = "film.mp4"
KNOWN = (
    ("film.mp4", "film"),
    ("metrics.json", "figures (metrics.json)"),
    ("run.json", "about the run (run.json)"),
    ("flight.json", "figures of the flight (flight.json)"),
    ("frames.jsonl", "a line a frame (frames.jsonl)"),
    ("model.onnx", "model (model.onnx)"),
    ("panels", "pictures (panels/)"),
    ("arrays", "arrays (arrays/)"),
    ("roc.svg", "ROC (roc.svg)"),
)
Point = tuple[float, float | None]


class Page:
    """Gathers frames; `close` writes `index.html` beside the other results.

    Args:
        folder: of the results.
        title: of the page.
        lead: the sentence that says what happened; asked for at the end.
        facts: more about the run, asked for at the end.
        film: whose picture stands where the film can be started, or None.

    Attributes:
        frames: that came.
        aucs: of frames with truth, by their time.
    """

    def __init__(
        self,
        folder: Path,
        title: str,
        lead: Callable[["Page"], str],
        facts: Callable[[], Sequence[tuple[str, str]]] = tuple,
        film: Film | None = None,
    ) -> None:
        self.frames = 0
        self.aucs: list[tuple[float, float]] = []
        self._nearest: list[Point] = []
        self._folder, self._title, self._lead, self._facts = folder, title, lead, facts
        self._stills = Stills()
        self._film = film
        self._threshold = 0.5

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        self.frames += 1
        self._threshold = prediction.threshold
        auc = auc_of(prediction.view, prediction.flown_score, frame.truth)
        if auc is not None:
            self.aucs.append((frame.time_s, auc))
        if ranges is not None and ranges.has_metres:
            near = ranges.nearest()
            self._nearest.append((frame.time_s, None if near is None else min(near[0], ranges.vehicle.far_m)))

        def drawn() -> Still:
            said = said_of(prediction, ranges, auc)
            return still(frame, prediction.view, {LEARNER: said}, ranges)

        self._stills.add(auc, drawn)

    def close(self) -> None:
        """Write the page; without a frame there is none."""
        if not self.frames:
            return
        slider = Slider("model", PAPER_SCORE, self._threshold)
        data = browser_data(self._stills.chosen(), {LEARNER: slider})
        sections: list[Section] = [Text(self._lead(self), lead=True)]
        films = sorted(path.name for path in self._folder.glob("film*.mp4"))
        poster = b"" if self._film is None else self._film.poster
        sections += [film_section(name, poster) for name in films]
        sections += [Heading("Frames"), Browser(data, facts=bool(self.aucs)), *self._charts()]
        if facts := self._facts():
            sections += [Heading("About this run"), Pairs(facts)]
        links = links_to(self._folder)
        if links:
            sections += [Heading("Files"), Links(links)]
        write_report(self._folder / "index.html", self._title, sections)

    def _charts(self) -> list[Section]:
        found: list[Section] = []
        if len(self.aucs) > 1:
            points: list[Point] = list(self.aucs)
            found.append(auc_chart([Line("model", points)]))
        if len(self._nearest) > 1:
            found.append(_nearest_chart(self._nearest))
        return [Heading("Over time"), *found] if found else []


def film_section(name: str = FILM, poster: bytes = b"") -> Video:
    """A film beside the page."""
    alt = "Film: image, the score that is flown, free, blocked and unknown bearings, the paper's maps."
    return Video(name, alt, poster)


def auc_chart(lines: Sequence[Line]) -> Chart:
    """AUC of each scored frame over its time."""
    times = [x for line in lines for x, _ in line.points]
    low = min((y for line in lines for _, y in line.points if y is not None), default=0.0)
    floor = max(0.0, np.floor(low * 10) / 10)
    return Chart(
        lines,
        "time, s",
        "AUC of the frame",
        (min(times), max(times)),
        (float(floor), 1.0),
        "AUC of the score that is flown on each scored frame, below the horizon, pooled over its pixels.",
        f"AUC of each scored frame over time; the lowest is {low:.2f}.",
        name="auc",
    )


def _nearest_chart(points: Sequence[Point]) -> Chart:
    metres = [y for _, y in points if y is not None]
    top = max(metres, default=1.0)
    return Chart(
        [Line("nearest obstacle", points)],
        "time, s",
        "metres",
        (points[0][0], points[-1][0]),
        (0.0, float(np.ceil(top))),
        "Distance of the nearest obstacle in view; gaps where none was met.",
        f"Distance of the nearest obstacle over time, at least {min(metres, default=0.0):.1f} m.",
        name="nearest",
    )


def links_to(folder: Path) -> list[tuple[str, str]]:
    """Links to those of the known results that lie in a folder."""
    return [(name, words) for name, words in KNOWN if (folder / name).exists()]
