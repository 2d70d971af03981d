"""Tables of metrics for the console, for Markdown and for the report."""

from collections.abc import Mapping, Sequence
from typing import Any

from horizon_dl.methods.names import printed_name

FIGURES = {
    "auc": "AUC",
    "auc_within_depression": "AUC within depression",
    "ap": "AP",
    "fpr90": "FPR90",
    "fpr95": "FPR95",
    "best_f1": "best F1",
}
HEADER = ("method", "score", *FIGURES.values())
_MISSING = "-"


def figure_text(scores: Mapping[str, Any], figure: str) -> str:
    """A figure with its spread where several seeds give one, such as `0.912 ± 0.004`; `-` where missing."""
    value, spread = scores.get(figure), scores.get(f"{figure}_sd")
    if value is None:
        return _MISSING
    # One seed, or a baseline without chance, has no spread to show.
    return f"{value:.3f} ± {spread:.3f}" if spread and spread >= 0.0005 else f"{value:.3f}"


def metrics_rows(metrics: Mapping[str, Any]) -> list[list[str]]:
    """Rows of `metrics.json`: method, score, then the figures in the order of `HEADER`.

    The pooled AUC and the AUC within depression always stand next to each other. The method's name stands
    in its first row only.
    """
    rows: list[list[str]] = []
    for method, values in metrics["methods"].items():
        name = printed_name(method)
        for score, figures in values.get("scores", {}).items():
            label = "" if score == "score" else score.replace("_", " ")
            rows.append([name, label, *(figure_text(figures, figure) for figure in FIGURES)])
            name = ""
    return rows


def method_rows(metrics: Mapping[str, Any]) -> list[list[str]]:
    """Rows of what a method has beside its scores, in the order of `METHOD_HEADER`."""
    rows: list[list[str]] = []
    for method, values in metrics["methods"].items():
        point = values.get("operating_point") or {}
        row = [
            printed_name(method),
            figure_text(values, "horizon_accuracy"),
            _number(values.get("train_s"), 1),
            _number(values.get("predict_ms_per_frame"), 1),
            str(point.get("rule", _MISSING)),
            _number(point.get("threshold"), 3),
            _rates(point),
            _rates(point, "_filtered"),
        ]
        if any(cell != _MISSING for cell in row[1:]):
            rows.append(row)
        other = values.get("operating_point_simulated")
        if other:
            gaps = [_MISSING] * 3
            rows.append(["", *gaps, other["rule"], _number(other["threshold"], 3), _rates(other), _MISSING])
    return rows


METHOD_HEADER = (
    "method",
    "horizon accuracy",
    "training, s",
    "ms a frame",
    "threshold rule",
    "threshold",
    "TPR / FPR",
    "after the filter",
)


def _number(value: float | None, digits: int) -> str:
    return _MISSING if value is None else f"{value:.{digits}f}"


def _rates(point: Mapping[str, Any], suffix: str = "") -> str:
    tpr, fpr = point.get(f"tpr{suffix}"), point.get(f"fpr{suffix}")
    return _MISSING if tpr is None or fpr is None else f"{tpr:.3f} / {fpr:.3f}"


def format_table(header: Sequence[str], rows: Sequence[Sequence[str]], text_columns: int = 1) -> str:
    """Aligned plain text: the first columns to the left, figures to the right, a rule under the header.

    Example:
        >>> print(format_table(["method", "AUC"], [["forest", "0.89"]]))
        method   AUC
        ------------
        forest  0.89
    """
    cells = [list(header), *[list(row) for row in rows]]
    widths = [max(len(line[column]) for line in cells) for column in range(len(header))]
    lines = [_aligned(line, widths, text_columns) for line in cells]
    return "\n".join([lines[0], "-" * (sum(widths) + 2 * (len(widths) - 1)), *lines[1:]])


def _aligned(line: Sequence[str], widths: Sequence[int], text_columns: int) -> str:
    padded = [
        cell.ljust(width) if column < text_columns else cell.rjust(width)
        for column, (cell, width) in enumerate(zip(line, widths, strict=True))
    ]
    return "  ".join(padded).rstrip()


def format_markdown(header: Sequence[str], rows: Sequence[Sequence[str]], text_columns: int = 1) -> str:
    """The same as a Markdown table; a `|` in a cell is escaped."""
    marks = ["---" if column < text_columns else "---:" for column in range(len(header))]
    escaped = [[cell.replace("|", "\\|") for cell in line] for line in [header, *rows]]
    lines = [escaped[0], marks, *escaped[1:]]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def metrics_table(metrics: Mapping[str, Any]) -> str:
    """The content of `metrics.json`, of `compare` or `evaluate`, as one table of methods and scores."""
    return format_table(HEADER, metrics_rows(metrics), text_columns=2)
