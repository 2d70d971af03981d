"""Options that several verbs share."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from horizon_dl.cli.console import is_verbose, say
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.vehicle.flight_params import FlightParams

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.runtime.signature import Signer


def add_config(parser: argparse.ArgumentParser) -> None:
    """`--config` and `--seed`; dotted options override single values."""
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="YAML file or name of a built-in config; --section.key VALUE overrides",
    )
    parser.add_argument("--seed", metavar="N", help="of the random numbers (default: the config's, 0)")


def add_values(parser: argparse.ArgumentParser, *sections: str) -> None:
    """Dotted options for these sections of the config alone, as they are in a trained run or a model."""
    parser.set_defaults(sections=sections, overrides=[])


def add_out(
    parser: argparse.ArgumentParser,
    default: Path | None = None,
    *,
    what: str = "where to write",
    required: bool = True,
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
        help="Dask cluster for features, forest and scoring (extra `cluster`); `local`: this machine",
    )


def add_vehicle_height(parser: argparse.ArgumentParser) -> None:
    """`--vehicle-height`."""
    parser.add_argument(
        "--vehicle-height",
        type=vehicle_height,
        metavar="BELOW,ABOVE",
        help="metres that the vehicle reaches below and above its camera: lower obstacles do not block "
        "(default: all do); ABOVE counts in measured distances alone",
    )


def vehicle_height(text: str) -> VehicleHeight:
    """Two lengths in metres.

    Example:
        >>> vehicle_height("0.3,0.1")
        VehicleHeight(below_m=0.3, above_m=0.1)
    """
    try:
        below, above = text.split(",")
        return VehicleHeight(float(below), float(above))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not BELOW,ABOVE in metres, such as 0.3,0.1") from None


def add_sign(parser: argparse.ArgumentParser) -> None:
    """`--sign`, for verbs that write model files; see `signer`."""
    parser.add_argument(
        "--sign", type=Path, metavar="KEY", help="sign the model files with an Ed25519 private key (PEM)"
    )


def signer(key: Path | None) -> "Signer | None":
    """What signs with the key that `--sign` names, if it names one."""
    from horizon_dl.runtime.signature import read_signer

    return None if key is None else read_signer(key)


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


def check_autopilot(arguments: argparse.Namespace, stale_s: float = FlightParams.stale_s) -> None:
    """InputError for values of `add_autopilot` that make no sense; `stale_s`: see `FlightParams`."""
    from horizon_dl.errors import InputError

    if arguments.system > 255:
        raise InputError(f"--system {arguments.system}", "is no MAVLink system id", "take 1 to 255")
    if not 0 <= arguments.camera_delay < stale_s:
        raise InputError(
            f"--camera-delay {arguments.camera_delay:g}",
            f"is not from 0 to {stale_s:g}",
            "an older picture is of no use to a flying robot",
        )


def resolve_config(arguments: argparse.Namespace) -> "Config":
    """The config that `--config`, `--seed` and the dotted options name."""
    from horizon_dl.config import load_config

    seed = [] if arguments.seed is None else [f"seed={arguments.seed}"]
    config = load_config(arguments.config, [*arguments.overrides, *seed])
    if is_verbose(arguments):
        changed = config.changed()
        say("config: " + (", ".join(f"{key} {value}" for key, value in changed.items()) or "the default"))
    return config


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
