"""Which truth a figure is about: all that stands on the floor, or what reaches the camera's height."""

from collections.abc import Mapping
from typing import Any

from horizon_dl.methods.names import printed_name
from horizon_dl.reporting.conclusion import headline_score
from horizon_dl.reporting.sections import Table
from horizon_dl.reporting.table import figure_text

TRUTHS = {
    "": "stands on the floor",
    "crossing": "reaches the camera's height",
    "low": "lower than the camera",
}
"""Blocks of a method in `metrics.json`, see `metrics.obstacle_height`; the method itself has all."""


def height_table(metrics: Mapping[str, Any]) -> Table | None:
    """AUC pooled / within depression bands of each method by the obstacles' height; None without ranges."""
    methods = metrics["methods"]
    if not any(method.get("crossing") or method.get("low") for method in methods.values()):
        return None
    rows = [
        [printed_name(name), headline_score(name).replace("_", " "), *_cells(name, method)]
        for name, method in methods.items()
    ]
    caption = (
        "AUC pooled / within depression bands of one degree, against the same floor, by the obstacles' "
        "height: the method promises what reaches the camera's height; who flies lower or drives needs all."
    )
    return Table(("method", "score", *TRUTHS.values()), rows, caption, text_columns=2)


def _cells(name: str, method: Mapping[str, Any]) -> list[str]:
    return [_both(method.get(block, {}) if block else method, name) for block in TRUTHS]


def _both(block: Mapping[str, Any] | None, name: str) -> str:
    scores = (block or {}).get("scores", {}).get(headline_score(name), {})
    return " / ".join(figure_text(scores, figure) for figure in ("auc", "auc_within_depression"))
