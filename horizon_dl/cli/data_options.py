"""The options that name data and all that may be given beside it."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from horizon_dl.data.given import Given
    from horizon_dl.data.source import Recording


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
        help="flu, frd, ...: where x, y, z point of the IMU that the calibration leads to, or whose table "
        "is the attitude",
    )
    parser.add_argument(
        "--convention",
        metavar="WORDS",
        help="how the attitude is to be read: xyzw, flu, z-up, deg, ...; calibrate-mount finds it",
    )
    parser.add_argument(
        "--attitude",
        metavar="FROM",
        help="a log's file, constant:ROLL,PITCH in degrees, from-images, or, of a camera, mavlink:URL",
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
        "--angle-unit", choices=("rad", "deg"), help="of the angles, or rates, in a table (found if left out)"
    )
    parser.add_argument(
        "--topic", action="append", default=[], metavar="NAME", help="of a bag, where several fit"
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


def open_data(arguments: argparse.Namespace) -> "Recording":
    """The recording that `DATA` and the options beside it name; InputError for a camera or stream."""
    from horizon_dl.sources.open_source import open_finished

    return open_finished(arguments.data, arguments.format, given(arguments))


def open_finding_axes(arguments: argparse.Namespace) -> tuple["Recording", str]:
    """As `open_data`; axes of an IMU that nothing states are found from the pictures.

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
