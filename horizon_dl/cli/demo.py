"""The whole story on the embedded data set: learn online, compare with the forest, export, run the export.

  horizon-dl demo --out DIR

DIR then holds index.html (also as report.html), film.mp4, metrics.json, model.onnx with its card, panels/.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from horizon_dl.cli.options import add_config, add_out, resolve_config

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.data.source import Recording
    from horizon_dl.evaluation.compare import Comparison
    from horizon_dl.training.run_folder import Run

FOREST_PIXELS = "forest.training_pixels=100000"
"""A quarter of the default: the forest is fitted eight times here."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_config(parser)
    add_out(parser, default=Path("demo"))


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """One pass over the embedded flight; every frame is predicted before it is learned from."""
    arguments.overrides.insert(0, FOREST_PIXELS)
    config = resolve_config(arguments)

    from horizon_dl.evaluation.compare import compare, split_recording
    from horizon_dl.export.smoke_test import export_and_try
    from horizon_dl.output import output_folder
    from horizon_dl.output.names import ResultNames
    from horizon_dl.readers.registry import open_recording
    from horizon_dl.reporting.comparison import write_comparison
    from horizon_dl.reporting.comparison_log import ComparisonLog
    from horizon_dl.reporting.table import metrics_table
    from horizon_dl.simulation.embedded import embedded_set
    from horizon_dl.training.predict import flight_rules

    recording = with_truth_of_every(3, open_recording(embedded_set()))
    split = split_recording(recording, "prequential")
    print(f"learning online from {len(split.train)} frames of the simulated arena, forest beside it")
    names = [one.name for one in recording.headers]
    with output_folder(arguments.out, "demo", overwrite=arguments.overwrite) as folder:
        log = ComparisonLog(folder, len(split.test), ResultNames(names), flight_rules(config))
        result = compare(recording, config, "prequential", [config.seed], on_frame=log, progress=True)
        write_comparison(folder, "Demo: the simulated arena, learned online", result, log, config)
        tried = export_and_try(learned_run(result, recording, config), recording, folder)
        told = tried.lines()
    print(metrics_table(result.metrics))
    print("\n".join(told))
    print(f"the report is {(arguments.out / 'report.html').absolute().as_uri()}")
    return {"out": arguments.out, "metrics": result.metrics}


def learned_run(result: "Comparison", recording: "Recording", config: "Config") -> "Run":
    """What was learned in the one pass, ready to be exported."""
    from horizon_dl.methods.names import NET
    from horizon_dl.training.frame_store import FrameStore
    from horizon_dl.training.train import finished_run

    assert result.net is not None
    store, frames = FrameStore(recording, config), int(result.metrics["frames"]["train"])
    return finished_run(result.net, store, frames, result.accumulators[NET][0].train_s)


def with_truth_of_every(step: int, recording: "Recording") -> "Recording":
    """The recording with every `step`-th truth alone, so that fewer frames are scored: it is a demo."""
    headers = [
        header if index % step == 0 else replace(header, labelled=False)
        for index, header in enumerate(recording.headers)
    ]
    return replace(recording, headers=headers)
