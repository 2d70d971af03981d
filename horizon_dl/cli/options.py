"""Options that several verbs share."""

import argparse
import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from horizon_dl.cli.console import is_verbose, say
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.vehicle.flight_params import FlightParams

if TYPE_CHECKING:
    from horizon_dl.config import Config
    from horizon_dl.data.given import Given
    from horizon_dl.data.source import Recording
    from horizon_dl.runtime.signature import Signer


def add_data(parser: argparse.ArgumentParser, name: str = "data") -> None:
    """`DATA` (or `SOURCE`) and all that may be given beside it."""
    what = "folder, film, log, camera:N or a stream's address"
    parser.add_argument(name, metavar=name.upper(), help=what)
    add_given(parser)


def add_given(parser: argparse.ArgumentParser) -> None:
    """`--format`, `--camera`, `--imu-axes`, `--convention`, `--attitude` and `--time-offset`."""
    parser.add_argument("--format", metavar="NAME", help="format of the data (recognised if left out)")
    parser.add_argument("--camera", type=Path, metavar="FILE", help="calibration and mount of the camera")
    parser.add_argument(
        "--imu-axes",
        metavar="AXES",
        help="flu, frd, ...: where x, y, z point of the IMU that the calibration leads to",
    )
    parser.add_argument(
        "--convention",
        metavar="WORDS",
        help="how the attitude is to be read: xyzw, flu, z-up, deg, ...; calibrate-mount finds it",
    )
    parser.add_argument(
        "--attitude",
        metavar="FROM",
        help="a log's file, mavlink:URL, constant:ROLL,PITCH in degrees, or from-images",
    )
    parser.add_argument(
        "--time-offset",
        type=time_offset,
        default=(0.0, 0.0, False),
        metavar="S[,PPM]",
        help="added to a log's times to give those of the images, and their clock's drift in millionths; "
        "`auto`: found from the pictures (default: 0)",
    )
    parser.add_argument(
        "--time-unit", choices=("s", "ms", "us", "ns"), help="of the times in a table (found if left out)"
    )
    parser.add_argument(
        "--angle-unit", choices=("rad", "deg"), help="of the angles in a table (found if left out)"
    )
    parser.add_argument(
        "--topic", action="append", default=[], metavar="NAME", help="of a bag, where several fit"
    )


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


def given(arguments: argparse.Namespace, *, needs_attitude: bool = True) -> "Given":
    """The values of `add_given`."""
    from horizon_dl.data.given import Given

    offset_s, drift_ppm, find = arguments.time_offset
    return Given(
        camera=arguments.camera,
        attitude=arguments.attitude,
        time_offset_s=offset_s,
        needs_attitude=needs_attitude,
        imu_axes=arguments.imu_axes,
        convention=arguments.convention,
        time_unit=arguments.time_unit,
        angle_unit=arguments.angle_unit,
        time_drift_ppm=drift_ppm,
        find_offset=find,
        topics=tuple(arguments.topic),
    )


def data_words(arguments: argparse.Namespace) -> str:
    """`DATA` and what was given beside it, as it is typed in a shell: for the hint at the next command."""
    offset_s, drift_ppm, find = arguments.time_offset
    offset = "auto" if find else f"{offset_s!r},{drift_ppm!r}" if offset_s or drift_ppm else None
    words = [str(arguments.data)]
    for option, value in {
        "--format": arguments.format,
        "--camera": arguments.camera,
        "--imu-axes": arguments.imu_axes,
        "--convention": arguments.convention,
        "--attitude": arguments.attitude,
        "--time-offset": offset,
        "--time-unit": arguments.time_unit,
        "--angle-unit": arguments.angle_unit,
    }.items():
        words += _typed(option, value)
    for topic in arguments.topic:
        words += _typed("--topic", topic)
    return shlex.join(words)


def _typed(option: str, value: object) -> list[str]:
    """An option with its value, nothing without one; what begins with a dash would be taken for an option."""
    text = str(value)
    return [] if value is None else [f"{option}={text}"] if text.startswith("-") else [option, text]


def open_data(arguments: argparse.Namespace) -> "Recording":
    """The recording that `DATA` and the options beside it name; InputError for a camera or stream."""
    from horizon_dl.sources.open_source import finished_recording, open_source

    return finished_recording(open_source(arguments.data, arguments.format, given(arguments)))


def open_finding_axes(arguments: argparse.Namespace) -> tuple["Recording", str]:
    """As `open_data`; the axes of an IMU that the calibration does not state are found from the pictures.

    Returns:
        The recording, and what was found in words; '' where nothing had to be.

    Raises:
        InputError: see `open_data`; AxesNotStatedError where the pictures do not tell either.
    """
    from horizon_dl.calibration.mount import AxesNotStatedError

    try:
        return open_data(arguments), ""
    except AxesNotStatedError:
        from horizon_dl.inspection.orientation import axes_line, find_imu_axes

        def open_with(axes: str) -> "Recording":
            return open_data(argparse.Namespace(**{**vars(arguments), "imu_axes": axes}))

        found = find_imu_axes(open_with, progress=True)
        if found is None:
            raise
        return open_with(found), axes_line(found)


def resolve_config(arguments: argparse.Namespace) -> "Config":
    """The config that `--config`, `--seed` and the dotted options name."""
    from horizon_dl.config import load_config

    seed = [] if arguments.seed is None else [f"seed={arguments.seed}"]
    config = load_config(arguments.config, [*arguments.overrides, *seed])
    if is_verbose(arguments):
        changed = config.changed()
        say("config: " + (", ".join(f"{key} {value}" for key, value in changed.items()) or "the default"))
    return config


def is_model_file(path: Path) -> bool:
    """Whether a MODEL is an exported file and no run folder."""
    return path.suffix == ".onnx" or path.is_file()


def time_offset(text: str) -> tuple[float, float, bool]:
    """For argparse: seconds and drift in millionths, or `auto`, as the last of the three.

    Example:
        >>> time_offset("-0.25,120"), time_offset("auto")
        ((-0.25, 120.0, False), (0.0, 0.0, True))
    """
    if text == "auto":
        return 0.0, 0.0, True
    try:
        seconds, *drift = (float(part) for part in text.split(","))
        values = (seconds, drift[0] if drift else 0.0)
    except ValueError:
        values = (math.nan, math.nan)
    if len(text.split(",")) > 2 or not all(math.isfinite(value) for value in values):
        raise argparse.ArgumentTypeError("must be seconds, seconds and drift as in 0.25,120, or auto")
    return *values, False


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
