"""Kalibr's camchain, also OpenVINS's: all its cameras; the axes of the IMU they lead to are not stated."""

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.rig_camera import imu_from_camera, rig_camera, rotation_of

NAME = "Kalibr camchain"
TO_CAMERA_BEFORE = "T_cn_cnm1"
"""Leads from the camera before it in the chain."""

_CAMERA = re.compile(r"cam\d+")


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return any(_CAMERA.fullmatch(name) and isinstance(value, Mapping) for name, value in tree.items())


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its cameras, by their names cam0, cam1, ... and topics."""
    names = [
        name
        for name, value in fields.content.items()
        if _CAMERA.fullmatch(name) and isinstance(value, Mapping)
    ]
    return [_candidate(name, fields) for name in names]


def _candidate(name: str, chain: Fields) -> Candidate:
    fields = chain.section(name)
    topic = fields.text("rostopic")
    size = fields.sizes("resolution") if fields.has("resolution") else None
    return Candidate((name, topic) if topic else (name,), size, lambda: _found(name, chain))


def _found(name: str, chain: Fields) -> Found:
    camera = rig_camera(chain.section(name), "distortion_coeffs")
    joined = _imu_from_camera(name, chain)
    return Found(camera) if joined is None else Found(camera, *joined)


def _imu_from_camera(name: str, chain: Fields) -> tuple[NDArray[np.float64], str] | None:
    """By the camera's own transform, else by that of the cameras before it in the chain."""
    fields = chain.section(name)
    own, before = imu_from_camera(fields), f"cam{int(name[3:]) - 1}"
    if own is not None or not fields.has(TO_CAMERA_BEFORE) or not chain.has(before):
        return own
    joined = _imu_from_camera(before, chain)
    if joined is None:
        return None
    return joined[0] @ rotation_of(fields, TO_CAMERA_BEFORE).T, joined[1]
