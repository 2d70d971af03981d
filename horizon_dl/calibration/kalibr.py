"""Kalibr's camchain: all its cameras; `T_cam_imu` leads to an IMU whose axes it does not state."""

import re
from collections.abc import Mapping

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.rig_camera import rig_camera, rotation_of

NAME = "Kalibr camchain"
_CAMERA = re.compile(r"cam\d+")


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return any(_CAMERA.fullmatch(name) and isinstance(value, Mapping) for name, value in tree.items())


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its cameras, by their names cam0, cam1, ... and topics."""
    return [
        _candidate(name, fields.section(name))
        for name, value in fields.content.items()
        if _CAMERA.fullmatch(name) and isinstance(value, Mapping)
    ]


def _candidate(name: str, fields: Fields) -> Candidate:
    topic = fields.text("rostopic")
    size = fields.sizes("resolution") if fields.has("resolution") else None
    return Candidate((name, topic) if topic else (name,), size, lambda: _found(fields))


def _found(fields: Fields) -> Found:
    camera = rig_camera(fields, "distortion_coeffs")
    if not fields.has("T_cam_imu"):
        return Found(camera)
    return Found(camera, rotation_of(fields, "T_cam_imu").T, f"{fields.prefix}T_cam_imu")
