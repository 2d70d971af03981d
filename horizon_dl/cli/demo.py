"""The whole story on the embedded data set: learn online, compare with the forest, write the report.

horizon-dl demo --out DIR
"""

import argparse
from pathlib import Path

from horizon_dl.cli.options import add_config, add_out, resolve_config


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_config(parser)
    add_out(parser, default=Path("demo"))


def run(arguments: argparse.Namespace) -> None:
    """One pass over the embedded flight; every frame is predicted before it is learned from."""
    config = resolve_config(arguments)

    from horizon_dl.evaluation.compare import compare, split_recording
    from horizon_dl.frames.formats import open_recording
    from horizon_dl.output import output_folder
    from horizon_dl.reporting.comparison import PanelWriter, write_comparison
    from horizon_dl.reporting.table import metrics_table
    from horizon_dl.simulation.embedded import embedded_set

    recording = open_recording(embedded_set())
    split = split_recording(recording, "prequential")
    print(f"learning online from {len(split.train)} frames of the simulated arena, forest beside it")
    with output_folder(arguments.out) as folder:
        panels = PanelWriter(folder, len(split.test))
        result = compare(recording, config, "prequential", [config.seed], on_frame=panels, progress=True)
        write_comparison(folder, "Demo: the simulated arena, learned online", result, panels, config)
    print(metrics_table(result.metrics))
    print(f"the report is {(arguments.out / 'report.html').absolute().as_uri()}")
