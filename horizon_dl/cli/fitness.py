"""No verb learns from what cannot work: the quick part of the data check, before anything else."""

import argparse
import sys
from typing import TYPE_CHECKING

from horizon_dl.cli.console import say, with_level

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.data.source import FrameSource


def add_force(parser: argparse.ArgumentParser) -> None:
    """`--force`."""
    parser.add_argument(
        "--force",
        action="store_true",
        help="go on with data of which the quick check says that it cannot work",
    )


def stop_if_unfit(source: "FrameSource", config: "Config", *, force: bool) -> None:
    """Say what the quick check finds wrong; what is live cannot be looked at beforehand.

    Raises:
        InputError: the data cannot work, and `force` is not set.
    """
    from horizon_dl.data.doubt import Doubt
    from horizon_dl.data.source import Recording
    from horizon_dl.errors import InputError
    from horizon_dl.inspection.quick_check import quick_check

    if not isinstance(source, Recording):
        return
    check = quick_check(source, config.labels.band_rad)
    for finding in check.findings:
        if finding.level != "ok":
            hint = f"\n  -> {finding.hint}" if finding.hint else ""
            say(with_level(f"{finding.level}: {finding.text}{hint}", sys.stderr))
    for note in source.notes:
        level = "warning" if isinstance(note, Doubt) else "note"
        say(with_level(f"{level}: {note}", sys.stderr))
    if check.level == "problem" and not force:
        problem = check.verdict.removeprefix("This data ").rstrip(".")
        if check.unreadable > check.sampled / 2:
            problem += f" (the first: {check.unreadable_examples[0][1]})"
        raise InputError(source.name, problem, "run check-data, or go on with --force")
