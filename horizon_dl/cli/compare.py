"""The net against the forest and training-free baselines, on the same frames.

  horizon-dl compare DATA --out DIR
  horizon-dl compare DATA --out DIR --protocol tail --seeds 1

DIR then holds index.html (also as report.html), film.mp4, metrics.json, roc.svg and panels/. Truth (labels/)
is used for scoring alone.
"""

import argparse
from typing import Any

from horizon_dl.cli.data_options import add_data, open_data
from horizon_dl.cli.fitness import add_force, stop_if_unfit
from horizon_dl.cli.options import (
    add_config,
    add_out,
    add_scheduler,
    add_vehicle_height,
    positive_int,
    resolve_config,
    say_skipped,
)
from horizon_dl.evaluation.protocols import PROTOCOLS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_config(parser)
    add_out(parser)
    add_force(parser)
    add_scheduler(parser)
    add_vehicle_height(parser)
    parser.add_argument(
        "--protocol",
        choices=PROTOCOLS,
        default="labelled-out",
        help="which frames are learned from and which scored (default: labelled-out)",
    )
    parser.add_argument(
        "--seeds", type=positive_int, default=3, metavar="N", help="runs of each learner (default: 3)"
    )
    parser.add_argument(
        "--jobs",
        type=positive_int,
        default=1,
        metavar="N",
        help="processes, among which the seeds after the first are dealt out (default: 1)",
    )


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Compare, write the figures, and print their table."""
    recording = open_data(arguments)
    config = resolve_config(arguments)
    stop_if_unfit(recording, config, force=arguments.force)

    from horizon_dl.config import save_config
    from horizon_dl.evaluation.compare import compare, split_recording
    from horizon_dl.evidence.self_assessment import said
    from horizon_dl.methods.names import NET
    from horizon_dl.output import output_folder
    from horizon_dl.output.names import ResultNames
    from horizon_dl.reporting.comparison import write_comparison
    from horizon_dl.reporting.comparison_log import ComparisonLog
    from horizon_dl.reporting.table import metrics_table
    from horizon_dl.training.predict import flight_rules
    from horizon_dl.workers import open_workers

    split = split_recording(recording, arguments.protocol)
    seeds = list(range(config.seed, config.seed + arguments.seeds))
    names = [one.name for one in recording.headers]
    with (
        output_folder(arguments.out, "compare", overwrite=arguments.overwrite) as folder,
        open_workers(arguments.scheduler) as workers,
    ):
        log = ComparisonLog(folder, len(split.test), ResultNames(names), flight_rules(config))
        result = compare(
            recording,
            config,
            arguments.protocol,
            seeds,
            on_frame=log,
            progress=True,
            workers=workers,
            jobs=min(arguments.jobs, 2 * len(seeds) - 1),
            vehicle=arguments.vehicle_height,
        )
        save_config(config, folder / "config.yaml")
        write_comparison(folder, f"{recording.name}, {arguments.protocol}", result, log, config)
    print(metrics_table(result.metrics))
    doubt = said(result.metrics["methods"][NET]["self_assessment"])
    if doubt is not None:
        print(f"the net says of itself: {doubt}")
    say_skipped(result.skipped)
    print(f"wrote {arguments.out / 'metrics.json'} and {arguments.out / 'report.html'}")
    return {"out": arguments.out, "metrics": result.metrics, "skipped": result.skipped}
