"""A comparison as files: metrics.json, ROC, film and one HTML report under two names."""

from pathlib import Path
from typing import Any

from horizon_dl.config import Config
from horizon_dl.evaluation.compare import Comparison
from horizon_dl.methods.names import printed_name
from horizon_dl.output import write_json, write_text
from horizon_dl.provenance import machine, versions
from horizon_dl.reporting.browser_data import Slider, browser_data
from horizon_dl.reporting.comparison_charts import (
    calibration_chart,
    pooled_roc,
    roc_chart,
    roc_lines,
)
from horizon_dl.reporting.comparison_distances import distance_sections
from horizon_dl.reporting.comparison_log import ComparisonLog
from horizon_dl.reporting.conclusion import conclusion
from horizon_dl.reporting.curves import roc_figure, save_figure
from horizon_dl.reporting.heights import height_table
from horizon_dl.reporting.html import report_html
from horizon_dl.reporting.run_page import FILM, auc_chart, film_section, links_to
from horizon_dl.reporting.sections import GLOSSARY, Browser, Heading, Links, Pairs, Section, Table, Text
from horizon_dl.reporting.table import HEADER, METHOD_HEADER, method_rows, metrics_rows
from horizon_dl.runtime.prediction import PAPER_SCORE

NAMES = ("report.html", "index.html")


def write_comparison(
    folder: Path, title: str, comparison: Comparison, log: ComparisonLog, config: Config
) -> None:
    """Write `metrics.json`, `roc.svg`, `report.html` and the same as `index.html` into an existing folder."""
    log.close()
    write_json(folder / "metrics.json", {**comparison.metrics, "versions": versions(), "machine": machine()})
    save_figure(folder / "roc.svg", roc_figure(roc_lines(comparison), title=title))
    page = report_html(title, report_sections(folder, comparison, log, config), _subtitle(comparison.metrics))
    for name in NAMES:
        write_text(folder / name, page)


def report_sections(
    folder: Path, comparison: Comparison, log: ComparisonLog, config: Config
) -> list[Section]:
    """Pictures first, then what they come to, then how it was made."""
    metrics = comparison.metrics
    sections: list[Section] = [
        Text(conclusion(metrics), lead=True),
        Heading("Frames"),
        *_frames(comparison, log),
    ]
    if log.film is not None and log.film.frames:
        sections += [Heading("Film"), film_section(FILM, log.film.poster)]
    sections += [Heading("Scores"), *_curves(comparison, log)]
    sections += [
        Table(HEADER, metrics_rows(metrics), "Obstacle against floor, below the horizon.", text_columns=2),
        *([by_height] if (by_height := height_table(metrics)) else []),
        Table(
            METHOD_HEADER,
            method_rows(metrics),
            "Learners: accuracy, times, rates of the paper's threshold.",
        ),
        *distance_sections(metrics, log),
        Heading("How this was made"),
        Pairs(setup_facts(comparison, config)),
        Links(links_to(folder)),
        Heading("Words"),
        GLOSSARY,
    ]
    return sections


def _frames(comparison: Comparison, log: ComparisonLog) -> list[Section]:
    stills = log.stills.chosen()
    if not stills:
        return [Text("No frame could be shown.")]
    sliders = {
        name: Slider(
            printed_name(name),
            PAPER_SCORE,
            log.thresholds[name],
            pooled_roc(comparison.accumulators[name], PAPER_SCORE),
        )
        for name in stills[0].said
    }
    return [Browser(browser_data(stills, sliders), facts=bool(log.aucs))]


def _curves(comparison: Comparison, log: ComparisonLog) -> list[Section]:
    found: list[Section] = []
    for chart in (roc_chart(comparison), calibration_chart(comparison), _aucs_chart(log)):
        if chart is not None:
            found.append(chart)
    return found


def _aucs_chart(log: ComparisonLog) -> Any:
    from horizon_dl.reporting.chart import Line

    lines = [Line(printed_name(name), list(points)) for name, points in log.aucs.items() if len(points) > 1]
    return auc_chart(lines) if lines else None


def _subtitle(metrics: dict[str, Any]) -> str:
    frames = metrics["frames"]
    return f"{metrics['data']}, {metrics['protocol']}: {frames['test']} frames scored"


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
