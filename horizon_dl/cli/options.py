"""Options that several verbs share."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.data.frame import Recording


def add_data(parser: argparse.ArgumentParser) -> None:
    """`DATA` and `--format`."""
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of the image set")
    add_format(parser)


def add_format(parser: argparse.ArgumentParser) -> None:
    """`--format`."""
    parser.add_argument("--format", metavar="NAME", help="format of DATA (recognised if left out)")


def add_config(parser: argparse.ArgumentParser) -> None:
    """`--config` and `--seed`; dotted options override single values."""
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="YAML file or name of a built-in config; --section.key VALUE overrides",
    )
    parser.add_argument("--seed", metavar="N", help="of the random numbers (default: the config's, 0)")


def add_out(
    parser: argparse.ArgumentParser, default: Path | None = None, *, what: str = "where to write", required: bool = True
) -> None:
    """`--out` and `--overwrite`."""
    shown = "" if default is None else f" (default: {default})"
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        required=required and default is None,
        default=default,
        help=f"{what}{shown}",
    )
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="write even where DIR holds something; it replaces earlier results, and files of the same names",
    )


def add_scheduler(parser: argparse.ArgumentParser) -> None:
    """`--scheduler`."""
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="Dask cluster for features, forest and scoring; `local`: processes of this machine",
    )


def add_autopilot(parser: argparse.ArgumentParser) -> None:
    """`--camera-delay`, `--system` and `--signing-key`."""
    parser.add_argument(
        "--camera-delay",
        type=float,
        default=0.0,
        metavar="S",
        help="from exposure to arrival of a picture; its attitude is that much older (default: 0)",
    )
    parser.add_argument(
        "--system", type=positive_int, default=1, metavar="ID", help="of the vehicle (default: 1)"
    )
    parser.add_argument(
        "--signing-key", type=Path, metavar="FILE", help="MAVLink 2 signing: key or pass phrase"
    )


def check_autopilot(arguments: argparse.Namespace) -> None:
    """InputError for values of `add_autopilot` that make no sense."""
    from horizon_dl.errors import InputError
    from horizon_dl.runtime.watchdog import STALE_S

    if arguments.system > 255:
        raise InputError(f"--system {arguments.system}", "is no MAVLink system id", "take 1 to 255")
    if not 0 <= arguments.camera_delay < STALE_S:
        raise InputError(
            f"--camera-delay {arguments.camera_delay:g}",
            f"is not from 0 to {STALE_S:g}",
            "an older picture is of no use to a flying robot",
        )


def open_data(arguments: argparse.Namespace) -> "Recording":
    """The recording that `DATA` and `--format` name."""
    from horizon_dl.data.readers.registry import open_recording

    return open_recording(arguments.data, arguments.format)


def resolve_config(arguments: argparse.Namespace) -> "Config":
    """The config that `--config`, `--seed` and the dotted options name."""
    from horizon_dl.config import load_config

    seed = [] if arguments.seed is None else [f"seed={arguments.seed}"]
    return load_config(arguments.config, [*arguments.overrides, *seed])


def is_model_file(path: Path) -> bool:
    """Whether a MODEL is an exported file and no run folder."""
    return path.suffix == ".onnx" or path.is_file()


def positive_int(text: str) -> int:
    """For argparse: a whole number of at least 1."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return value


def say_skipped(skipped: dict[str, str]) -> None:
    """Print how many frames were left out, and why the first one was."""
    if skipped:
        first = next(iter(skipped.values()))
        print(f"left out {len(skipped)} frame{'s' * (len(skipped) > 1)}; the first: {first}")
