"""Whether a data set can work, and why not.

horizon-dl check-data DATA
horizon-dl check-data DATA --out DIR      also writes check.json, horizon overlays and index.html
horizon-dl check-data DATA --quick-train  also trains a net for a minute and hears what it says of itself
"""

import argparse
import sys
from dataclasses import replace
from typing import Any

from horizon_dl.cli.console import with_level
from horizon_dl.cli.data_options import add_data, open_finding_axes
from horizon_dl.cli.options import add_config, add_out, resolve_config


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_config(parser)
    add_out(parser, what="where to write overlays and the report", required=False)
    parser.add_argument(
        "--quick-train",
        action="store_true",
        help="also train a net for about a minute and say whether it is to be trusted here",
    )


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Check, print the findings, and write the pictures where asked for."""
    recording, axes = open_finding_axes(arguments)
    config = resolve_config(arguments)

    from horizon_dl.inspection.data_check import check_recording
    from horizon_dl.inspection.findings import with_findings
    from horizon_dl.output import output_folder
    from horizon_dl.reporting.check import check_lines, write_check

    check = check_recording(
        recording,
        band_rad=config.labels.band_rad,
        max_pixels=config.image.max_pixels,
        orientation=True,
        progress=True,
    )
    hopeless = check.level == "problem"
    if arguments.quick_train and not hopeless:
        from horizon_dl.training.quick import quick_assessment

        said = quick_assessment(recording, config, progress=True)
        check = with_findings(replace(check, self_assessment=said))
    if axes:
        print(axes)
    for line in check_lines(check):
        print(with_level(line, sys.stdout))
    if arguments.out:
        with output_folder(arguments.out, "check-data", overwrite=arguments.overwrite) as folder:
            write_check(check, folder)
        print(f"wrote {arguments.out / 'index.html'}")
    if arguments.quick_train and hopeless:
        print("no net was trained: this data cannot work")
    return check.to_json()
