"""A trained net, or the ONNX file it was exported to, against the truth of a data set.

  horizon-dl evaluate RUN DATA --out DIR
  horizon-dl evaluate MODEL.onnx DATA --out DIR

DIR then holds index.html (also as report.html), film.mp4, metrics.json, roc.svg and panels/.
"""

import argparse
from pathlib import Path
from typing import Any

from horizon_dl.cli.data_options import add_data, open_data
from horizon_dl.cli.options import add_out, add_scheduler, add_vehicle_height, say_skipped


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("run_folder", type=Path, metavar="RUN", help="what `train --out` or `export` wrote")
    add_data(parser)
    add_out(parser)
    add_scheduler(parser)
    add_vehicle_height(parser)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Evaluate, write the figures, and print their table."""
    from horizon_dl.methods.open_predictor import is_model_file

    if not is_model_file(arguments.run_folder):
        from horizon_dl.training.run_files import check_run_folder

        check_run_folder(arguments.run_folder)
    from horizon_dl.evaluation.evaluate import evaluate
    from horizon_dl.methods.onnx_file import load_file_run
    from horizon_dl.output import output_folder
    from horizon_dl.output.names import ResultNames
    from horizon_dl.reporting.comparison import write_comparison
    from horizon_dl.reporting.comparison_log import ComparisonLog
    from horizon_dl.reporting.table import metrics_table
    from horizon_dl.training.predict import flight_rules
    from horizon_dl.training.run_folder import load_run
    from horizon_dl.workers import open_workers

    load = load_file_run if is_model_file(arguments.run_folder) else load_run
    trained = load(arguments.run_folder)
    recording = open_data(arguments)
    labelled = sum(entry.labelled for entry in recording.headers)
    names = [one.name for one in recording.headers]
    with (
        output_folder(arguments.out, "evaluate", overwrite=arguments.overwrite) as folder,
        open_workers(arguments.scheduler) as workers,
    ):
        log = ComparisonLog(folder, labelled, ResultNames(names), flight_rules(trained.config))
        result = evaluate(
            trained,
            recording,
            on_frame=log,
            progress=True,
            workers=workers,
            vehicle=arguments.vehicle_height,
        )
        title = f"{arguments.run_folder.name} on {recording.name}"
        write_comparison(folder, title, result, log, trained.config)
    print(metrics_table(result.metrics))
    say_skipped(result.skipped)
    print(f"wrote {arguments.out / 'metrics.json'} and {arguments.out / 'report.html'}")
    return {"out": arguments.out, "metrics": result.metrics, "skipped": result.skipped}
