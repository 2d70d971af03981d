"""Every method on every set, as `horizon-dl compare` gives it."""

from collections.abc import Mapping, Sequence
from typing import Any

from nets import open_set

from horizon_dl.config import load_config
from horizon_dl.evaluation.compare import compare
from horizon_dl.reporting.table import format_markdown

OTHER_HEADLINES = {"cnn": "entropy", "rf": "entropy"}
OTHERS = {
    "above": "above the horizon, obstacle against ceiling and sky",
    "crossing": "second truth: obstacles that reach the camera's height",
    "low": "only obstacles lower than the camera",
}

RANGING = ("median_relative_error", "missed", "false_stop", "unknown", "within_2sd")


def methods_figures(name: str, seeds: Sequence[int]) -> dict[str, Any]:
    """The blocks `methods` and `ranging` of `metrics.json`, protocol labelled-out."""
    metrics = compare(open_set(name), load_config(), "labelled-out", list(seeds)).metrics
    return {block: metrics[block] for block in ("methods", "ranging")}


def methods_markdown(found: Mapping[str, Any]) -> str:
    """Every score of every method; a cell is the pooled AUC / the AUC within depression bands."""
    rows = [
        [f"{method}, {score}", *(cell(blocks[method]["scores"][score]) for blocks in found.values())]
        for method, block in next(iter(found.values())).items()
        for score in block["scores"]
    ]
    return f"## Methods\n\n{format_markdown(['method, score', *found], rows)}"


def second_truth_markdown(found: Mapping[str, Any]) -> str:
    """The headline scores against other pixels: above the horizon, and by the obstacles' height."""
    tables = []
    for other, title in OTHERS.items():
        sets = [name for name, blocks in found.items() if other in next(iter(blocks.values()))]
        if sets:
            rows = [
                [f"{method}, {score}", *(cell(found[name][method][other]["scores"][score]) for name in sets)]
                for method, score in _headlines(found[sets[0]])
            ]
            tables.append(f"**{title}**\n\n{format_markdown(['method, score', *sets], rows)}")
    return "## Other truths\n\n" + "\n\n".join(tables)


def threshold_markdown(found: Mapping[str, Any]) -> str:
    """Found / false positives by the net's entropy: the least with 90 % found, then by both rules.

    And what the net says of itself, and the forest's false positives with 90 % found.
    """
    header = ["set", "90 % found", "forest, 90 % found", "percentile", "youden-simulated", "contradicted", ""]
    rows = []
    for name, methods in found.items():
        net, forest = methods["cnn"], methods["rf"]
        least = [f".90 / {method['scores']['entropy']['fpr90']:.3f}" for method in (net, forest)]
        points = [net.get(f"operating_point{rule}") for rule in ("", "_simulated")]
        rates = ["-" if point is None else f"{point['tpr']:.3f} / {point['fpr']:.3f}" for point in points]
        said = net["self_assessment"]
        rows.append([name, *least, *rates, f"{said['contradicted']:.3f}", said["verdict"]])
    return f"## Thresholds\n\n{format_markdown(header, rows)}"


def ranging_markdown(found: Mapping[str, Any]) -> str:
    """Free distances by the first seed's net, and by the truth's own floor, where there are measured ones."""
    columns = ["set, floor", *RANGING, "bearings"]
    rows = [
        [f"{name}, {floor}", *(f"{figures[key]:.3f}" for key in RANGING), str(figures["columns"])]
        for name, block in found.items()
        for floor, figures in (("the net's", block), ("the truth's", block["true_floor"]))
        if figures["columns"]
    ]
    return f"## Ranging\n\n{format_markdown(columns, rows)}"


def _headlines(blocks: Mapping[str, Any]) -> list[tuple[str, str]]:
    rows = [(method, OTHER_HEADLINES.get(method, "score")) for method in blocks]
    return [*rows, ("cnn", "surprisal"), ("cnn", "fused")]


def cell(figures: Mapping[str, float | None]) -> str:
    """Pooled / within, and the larger of their spreads over the seeds; `-` where there is none."""
    if figures["auc"] is None or figures["auc_within_depression"] is None:
        return "-"
    spread = max(figures["auc_sd"] or 0.0, figures["auc_within_depression_sd"] or 0.0)
    return f"{figures['auc']:.3f} / {figures['auc_within_depression']:.3f} (±{spread:.3f})"
