"""The camera's mount error (roll, pitch) and the attitude's convention, from the images themselves.

  horizon-dl calibrate-mount DATA
  horizon-dl calibrate-mount DATA --out DIR      also writes mount.json

First: by which convention is the attitude to be read (order of a quaternion, degrees, axes of the body and
of the world)? The one under which up goes where the turns seen in the pictures carry it. The axes of an IMU
that a Kalibr file leads to, or whose samples are the attitude, are found in the same way.

Upright edges (walls, doors, posts) show where up lies; what the attitude says otherwise, on average over
the recording, is the mount's error; up to 36 degrees are looked for. Level edges give a second opinion on
the pitch. The yaw does not matter to the horizon. Errors of the lens calibration are not seen: trust it to
a degree. Where no upright edges are in view, it says so and ends with exit code 2.
"""

import argparse
from typing import Any

from horizon_dl.cli.data_options import add_data, open_finding_axes
from horizon_dl.cli.options import add_out


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_out(parser, what="where to write mount.json", required=False)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Look at the images and print the convention and the correction."""
    recording, axes = open_finding_axes(arguments)

    from horizon_dl.errors import InputError
    from horizon_dl.inspection.mount_check import check_mount, mount_lines
    from horizon_dl.inspection.orientation import check_convention

    convention = check_convention(recording, progress=True)
    says = [axes] if axes else []
    says += convention.lines() if convention else []
    if convention and convention.option:
        recording = recording.read_as(convention.option)
    found: dict[str, Any] = {"convention": convention.option if convention else "", "imu_axes": axes}
    try:
        check = check_mount(recording, progress=True)
        says += mount_lines(check)
        found |= check.to_json()
    except InputError as error:
        if not any(found.values()):
            raise
        says.append(f"{error}.")
    print("\n".join(says))
    if arguments.out:
        _write(arguments, found)
    return found


def _write(arguments: argparse.Namespace, found: dict[str, Any]) -> None:
    from horizon_dl.output import output_folder, write_json
    from horizon_dl.output.files import without_nan

    with output_folder(arguments.out, "calibrate-mount", overwrite=arguments.overwrite) as folder:
        write_json(folder / "mount.json", without_nan(found))
    print(f"wrote {arguments.out / 'mount.json'}")
