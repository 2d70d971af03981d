"""A comparison as files: metrics.json, ROC, panels and one HTML report."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.evaluation.compare import Comparison
from horizon_dl.evaluation.scoring import ScoredFrame
from horizon_dl.evidence.place import Place
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.metrics.accumulators import Tally
from horizon_dl.metrics.calibration_error import Reliability
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.output import write_json
from horizon_dl.output.names import ResultNames
from horizon_dl.provenance import machine, versions
from horizon_dl.reporting.curves import (
    Floats,
    OperatingPoint,
    RocLine,
    figure_bytes,
    reliability_figure,
    roc_figure,
    save_figure,
)
from horizon_dl.reporting.html import write_report
from horizon_dl.reporting.sections import GLOSSARY, Figure, Heading, Pairs, Section, Table, Text
from horizon_dl.reporting.table import HEADER, METHOD_HEADER, METHOD_NAMES, method_rows, metrics_rows
from horizon_dl.training.predict import Prediction
from horizon_dl.uncertainty.measures import P_ABOVE
from horizon_dl.uncertainty.obstacle_map import obstacle_map
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.panels import PanelRow, frame_panel, image_bytes, save_panel
from horizon_dl.visualization.range_picture import range_picture

MOST_PANELS = 8
HEADLINE = {"cnn": "entropy", "rf": "entropy"}


class PanelWriter:
    """Writes panels of some test frames while a comparison runs, and remembers them for the report.

    Args:
        folder: the panels go to `folder/panels`.
        frames: how many frames will come; at most 8 of them, evenly spread, are drawn.
    """

    def __init__(self, folder: Path, frames: int) -> None:
        self._folder = folder / "panels"
        self._every = max(1, -(-frames // MOST_PANELS))
        self._count = 0
        self._names = ResultNames()
        self.pictures: list[tuple[str, bytes]] = []

    def __call__(self, scored: ScoredFrame) -> None:
        """Take one test frame."""
        if self._count % self._every == 0:
            panel = comparison_panel(scored)
            save_panel(self._folder / f"{self._names(scored.frame.name)}.jpg", panel)
            self.pictures.append((scored.frame.name, image_bytes(panel, "JPEG")))
        self._count += 1


def comparison_panel(scored: ScoredFrame) -> Image:
    """Image, classification, uncertainty, obstacle map, distances and truth; a row a learner."""
    rows = [
        PanelRow(
            METHOD_NAMES[name],
            p_above=maps[P_ABOVE],
            uncertainty=maps["entropy"],
            obstacles=obstacle_map(maps["entropy"], scored.thresholds[name]),
            ranges=ranges_of(scored.frame, maps[P_ABOVE], scored.thresholds[name]),
        )
        for name, maps in scored.maps.items()
        if P_ABOVE in maps
    ]
    return frame_panel(
        scored.view.image, scored.view.elevation, rows, scored.frame.truth, title=scored.frame.name
    )


def prediction_panel(
    prediction: Prediction, frame: Frame, threshold: float, place: Place | None = None
) -> Image:
    """Image, classification, uncertainty, obstacle map; distances and truth where the frame has them."""
    found, view = prediction.measures, prediction.view
    ranges = ranges_of(frame, found.p_above, threshold, place)
    row = PanelRow("", found.p_above, found.entropy, prediction.obstacles, ranges=ranges)
    return frame_panel(view.image, view.elevation, [row], frame.truth, title=frame.name)


def ranges_of(frame: Frame, p_above: Floats, threshold: float, place: Place | None = None) -> Image | None:
    """The picture of distances per bearing of a map (h, w), or None for frames without a height."""
    if frame.height_m is None:
        return None
    height, width = p_above.shape
    directions = camera_rays(frame.calibrated.scaled(width, height)).directions
    return range_picture(frame, directions, p_above.astype(np.float32), threshold, place)


def write_comparison(
    folder: Path, title: str, comparison: Comparison, panels: PanelWriter, config: Config
) -> None:
    """Write `metrics.json`, `roc.svg` and `report.html` into a folder that exists."""
    metrics = {**comparison.metrics, "versions": versions(), "machine": machine()}
    write_json(folder / "metrics.json", metrics)
    roc = roc_figure(roc_lines(comparison), title=title)
    save_figure(folder / "roc.svg", roc)
    sections: list[Section] = [
        Text(_summary(comparison.metrics), lead=True),
        Heading("Scores"),
        Table(HEADER, metrics_rows(metrics), "Obstacle against floor, below the horizon.", text_columns=2),
        Table(METHOD_HEADER, method_rows(metrics), "Learners: accuracy, times, and the threshold's rates."),
        Figure(figure_bytes(roc), "ROC; filled: the threshold's rates, open: after the neighbour filter."),
        *_calibration(comparison),
        Heading("Panels"),
        *(Figure(content, caption=name, wide=True) for name, content in panels.pictures),
        Heading("How this was made"),
        Pairs(setup_facts(comparison, config)),
        Heading("Words"),
        GLOSSARY,
    ]
    write_report(folder / "report.html", title, sections)


def roc_lines(comparison: Comparison) -> list[RocLine]:
    """The curve of every method's headline score, pooled over seeds; position and diffusion dashed."""
    lines = []
    for method, tallies in comparison.tallies.items():
        score = HEADLINE.get(method, "score")
        curve = _pooled_curve(tallies, score)
        if curve is None:
            continue
        block = comparison.metrics["methods"][method]
        fpr, tpr = curve
        lines.append(
            RocLine(
                METHOD_NAMES.get(method, method),
                fpr,
                tpr,
                auc=block["scores"][score]["auc"],
                baseline=method not in HEADLINE,
                points=_points(block.get("operating_point")),
            )
        )
    return lines


def _calibration(comparison: Comparison) -> list[Section]:
    """The learners' reliability over all seeds, their expected calibration errors in the legend."""
    lines = {}
    for method, tallies in comparison.tallies.items():
        pooled = Reliability()
        for tally in tallies:
            pooled.merge(tally.calibration)
        if (error := pooled.error()) is not None:
            predicted, observed, _ = pooled.curve()
            lines[f"{METHOD_NAMES[method]}, error {error:.3f}"] = (predicted, observed)
    caption = "Calibration of p_above. Softened targets keep the net unsure where the plain side is certain."
    return [Figure(figure_bytes(reliability_figure(lines)), caption)] if lines else []


def setup_facts(comparison: Comparison, config: Config) -> list[tuple[str, str]]:
    """Protocol, seeds, frames, settings, machine and versions, as pairs of text."""
    metrics = comparison.metrics
    frames = metrics["frames"]
    return [
        ("data", metrics["data"]),
        ("protocol", metrics["protocol"]),
        ("seeds", ", ".join(map(str, metrics["seeds"]))),
        ("frames", f"{frames['train']} train, {frames['test']} test, {frames['skipped']} could not be used"),
        ("target", config.target.kind),
        ("net", f"{config.model.kind}, dropout {config.model.dropout:g}, {config.model.samples} samples"),
        ("machine", ", ".join(str(value) for value in machine().values())),
        ("versions", ", ".join(f"{name} {number}" for name, number in versions().items())),
    ]


def _pooled_curve(tallies: Sequence[Tally], score: str) -> tuple[Floats, Floats] | None:
    pooled = RocAccumulator()
    for tally in tallies:
        if score in tally.rocs:
            pooled.merge(tally.rocs[score])
    return pooled.curve()


def _points(point: dict[str, Any] | None) -> list[OperatingPoint]:
    if not point or point["tpr"] is None or point["fpr"] is None:
        return []
    return [
        OperatingPoint(point["fpr"], point["tpr"]),
        OperatingPoint(point["fpr_filtered"], point["tpr_filtered"], filtered=True),
    ]


def _summary(metrics: dict[str, Any]) -> str:
    methods = metrics["methods"]
    parts = []
    for name in ("cnn", "rf", "position"):
        scores = methods.get(name, {}).get("scores", {})
        figures = scores.get(HEADLINE.get(name, "score"))
        if figures and figures["auc"] is not None and figures["auc_within_depression"] is not None:
            pooled, within = figures["auc"], figures["auc_within_depression"]
            parts.append(f"{METHOD_NAMES[name]} {pooled:.3f} pooled and {within:.3f} within depression")
    if not parts:
        return "Without truth below the horizon there are no figures, only pictures."
    return f"AUC of the predictive entropy on {metrics['data']}: " + "; ".join(parts) + "."
