"""A comparison of made-up frames, small enough for every test of the report."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scene import scene

from horizon_dl.config import load_config
from horizon_dl.evaluation.compare import Comparison
from horizon_dl.evaluation.scoring import ScoredFrame, count_frame
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.metrics import method_metrics
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.reporting.comparison import write_comparison
from horizon_dl.reporting.comparison_log import ComparisonLog
from horizon_dl.reporting.run_page import Page
from horizon_dl.runtime.ranged import ranges_of
from horizon_dl.uncertainty.measures import p_other_side

FRAMES = 14


def write_report_of_scenes(folder: Path, frames: int = FRAMES) -> Path:
    """`report.html` of a net, a forest and position alone; its path."""
    config = load_config(None, [])
    accumulators = {name: MethodAccumulator() for name in ("cnn", "rf", "position")}
    log = ComparisonLog(folder, frames)
    for index in range(frames):
        frame, prediction = scene(index)
        view, found = prediction.view, prediction.measures
        near = np.clip(1.0 + view.elevation / 1.6, 0.0, 1.0).astype(np.float32)
        maps = {name: getattr(found, name) for name in vars(found) if name != "surprisal"}
        maps["surprisal"] = p_other_side(found.p_above, view.elevation > 0)
        maps["fused"] = (0.5 * maps["entropy"] + 0.5 * near).astype(np.float32)
        forest = {name: (0.5 * value + 0.25).astype(np.float32) for name, value in maps.items()}
        forest["entropy"] = (0.5 * near + 0.5 * maps["entropy"] * (index % 3 != 0)).astype(np.float32)
        scored = ScoredFrame(
            frame, view, {"cnn": maps, "rf": forest, "position": {"score": near}}, {"cnn": 0.5, "rf": 0.6}
        )
        count_frame(accumulators, scored, 0.01)
        log(scored)
    metrics = {
        "schema": 1,
        "data": "scenes",
        "protocol": "labelled-out",
        "seeds": [0],
        "frames": {"train": 50, "test": frames, "skipped": 0},
        "methods": {
            name: method_metrics([accumulator], "percentile-25") for name, accumulator in accumulators.items()
        },
        "ranging": RangingBlock().compute(),
    }
    comparison = Comparison(metrics, {name: [accumulator] for name, accumulator in accumulators.items()})
    write_comparison(folder, "Scenes", comparison, log, config)
    return folder / "report.html"


def write_page_of_scenes(folder: Path, frames: int, change: Callable = lambda frame: frame) -> Path:
    """`index.html` of a run; its path."""
    page = Page(folder, "A run", lambda page: f"{page.frames} frames.")
    for index in range(frames):
        frame, prediction = scene(index)
        page.log(change(frame), prediction, ranges_of(frame, prediction))
    page.close()
    return folder / "index.html"
