"""The camera's mount error (roll, pitch) from the images themselves.

  horizon-dl calibrate-mount DATA
  horizon-dl calibrate-mount DATA --out DIR      also writes mount.json

Upright edges (walls, doors, posts) show where up lies; what the attitude says otherwise, on average over
the recording, is the mount's error. Level edges give a second opinion on the pitch. The yaw does not matter
to the horizon. Errors of the lens calibration are not seen: trust it to a degree. Where no upright edges are
in view, it says so and ends with exit code 2.
"""

import argparse
from pathlib import Path

from horizon_dl.cli.options import add_data, open_data


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    parser.add_argument("--out", type=Path, metavar="DIR", help="where to write mount.json")


def run(arguments: argparse.Namespace) -> None:
    """Look at the images and print the correction."""
    recording = open_data(arguments)

    from horizon_dl.inspection.mount_check import check_mount, mount_lines
    from horizon_dl.output import output_folder, write_json

    check = check_mount(recording, recording.mount_rpy_rad or (0.0, 0.0, 0.0), progress=True)
    print("\n".join(mount_lines(check)))
    if recording.mount_rpy_rad is None and check.is_off:
        print("This format has no camera.yaml: the angles are about the camera's own axes.")
    if arguments.out:
        with output_folder(arguments.out) as folder:
            write_json(folder / "mount.json", check.to_json())
        print(f"wrote {arguments.out / 'mount.json'}")
