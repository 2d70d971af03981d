"""Stated over measured distances: a chart and two tables."""

from itertools import pairwise
from typing import Any

import numpy as np

from horizon_dl.reporting.chart import Chart, Line
from horizon_dl.reporting.comparison_log import ComparisonLog
from horizon_dl.reporting.sections import Heading, Section, Table

MOST_DISTANCES = 1500
SHARES = 4


def distance_sections(metrics: dict[str, Any], log: ComparisonLog) -> list[Section]:
    """Stated over true distances with a table; nothing where none were measured."""
    block = metrics.get("ranging") or {}
    if not block.get("columns") or not (log.distances or log.covered):
        return []
    pairs = [*log.distances, *log.covered]
    far_m = float(np.ceil(1.3 * max(block["interval_m"][1], 1.0)))
    lines = [
        Line(name, _thinned(points, far_m), dots=True)
        for name, points in (("foot in view", log.distances), ("at most: foot out of view", log.covered))
        if points
    ]
    caption = (
        f"Nearest obstacle of each degree of bearing, {len(pairs)} bearings; the dotted line is the truth."
    )
    median = block["median_relative_error"]
    alt = f"Stated over true distance; median error {_percent(median)} of the distance."
    axes = "measured, m", "stated, m"
    chart = Chart(lines, *axes, (0.0, far_m), (0.0, far_m), caption, alt, diagonal=True, name="distances")
    return [Heading("Distances"), chart, _distance_table(log, block), _ranging_table(block)]


def _thinned(points: list[tuple[float, float]], far_m: float) -> list[tuple[float, float | None]]:
    kept = [(x, y) for x, y in points if x <= far_m]
    step = max(1, -(-len(kept) // MOST_DISTANCES))
    return [(round(x, 2), round(min(y, far_m), 2)) for x, y in kept[::step]]


def _distance_table(log: ComparisonLog, block: dict[str, Any]) -> Table:
    near_m, far_m = block["interval_m"]
    edges = np.linspace(near_m, far_m, SHARES + 1)
    truth, stated = np.array(log.distances or [(np.nan, np.nan)]).T
    rows = []
    for low, high in pairwise(edges.tolist()):
        used = (truth >= low) & (truth < high)
        error = (stated[used] - truth[used]) / truth[used]
        shown = (
            ["-", "-"] if not used.any() else [_percent(np.median(np.abs(error))), _percent(np.median(error))]
        )
        rows.append([f"{low:.1f} to {high:.1f} m", str(int(used.sum())), *shown])
    header = ("true distance", "bearings", "median error", "median of too far (+) or near (-)")
    return Table(header, rows, "Bearings whose obstacle has its foot in view.")


def _ranging_table(block: dict[str, Any]) -> Table:
    header = ("floor", "bearings", "median error", "missed", "false stops", "within two stated deviations")
    rows = []
    for name, one in (("the learner's", block), ("the truth's own", block.get("true_floor"))):
        if one and one.get("columns"):
            shares = (one[key] for key in ("median_relative_error", "missed", "false_stop", "within_2sd"))
            rows.append([name, str(one["columns"]), *map(_percent, shares)])
    near_m, far_m = block["interval_m"]
    caption = (
        f"True distances of {near_m:g} to {far_m:g} m. Missed: said to be free beyond 1.5 times them. "
        "False stop: said to be under 0.67 times."
    )
    return Table(header, rows, caption)


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f} %"
