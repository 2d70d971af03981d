"""Options that several verbs share."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.frames.frame import Recording


def add_data(parser: argparse.ArgumentParser) -> None:
    """`DATA` and `--format`."""
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of the image set")
    parser.add_argument("--format", metavar="NAME", help="format of DATA (recognised if left out)")


def add_config(parser: argparse.ArgumentParser) -> None:
    """`--config`; dotted options override single values."""
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="YAML file or name of a built-in config; --section.key VALUE overrides",
    )


def add_out(parser: argparse.ArgumentParser, default: Path | None = None) -> None:
    """`--out`."""
    required = default is None
    shown = "" if required else f" (default: {default})"
    parser.add_argument(
        "--out", type=Path, metavar="DIR", required=required, default=default, help=f"where to write{shown}"
    )


def add_scheduler(parser: argparse.ArgumentParser) -> None:
    """`--scheduler`."""
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="Dask cluster for features, forest and scoring; `local`: processes of this machine",
    )


def open_data(arguments: argparse.Namespace) -> "Recording":
    """The recording that `DATA` and `--format` name."""
    from horizon_dl.frames.formats import open_recording

    return open_recording(arguments.data, arguments.format)


def resolve_config(arguments: argparse.Namespace) -> "Config":
    """The config that `--config` and the dotted options name."""
    from horizon_dl.config import load_config

    return load_config(arguments.config, arguments.overrides)


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
