"""The camera's mount error (roll, pitch) from the images themselves.

  horizon-dl calibrate-mount DATA
  horizon-dl calibrate-mount DATA --out DIR      also writes mount.json

Upright edges (walls, doors, posts) show where up lies; what the attitude says otherwise, on average over
the recording, is the mount's error. Level edges give a second opinion on the pitch. The yaw does not matter
to the horizon. Errors of the lens calibration are not seen: trust it to a degree. Where no upright edges are
in view, it says so and ends with exit code 2.
"""

import argparse

from horizon_dl.cli.options import add_data, add_out, open_data


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    add_data(parser)
    add_out(parser, what="where to write mount.json", required=False)


def run(arguments: argparse.Namespace) -> None:
    """Look at the images and print the correction."""
    recording = open_data(arguments)

    from horizon_dl.inspection.mount_check import check_mount, mount_lines
    from horizon_dl.output import output_folder, write_json
    from horizon_dl.output.files import without_nan

    check = check_mount(recording, recording.mount_rpy_rad or (0.0, 0.0, 0.0), progress=True)
    print("\n".join(mount_lines(check)))
    if recording.mount_rpy_rad is None and check.is_off:
        print("This format has no camera.yaml: the angles are about the camera's own axes.")
    if arguments.out:
        with output_folder(arguments.out, "calibrate-mount", overwrite=arguments.overwrite) as folder:
            write_json(folder / "mount.json", without_nan(check.to_json()))
        print(f"wrote {arguments.out / 'mount.json'}")
