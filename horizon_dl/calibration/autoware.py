"""Autoware's calibration: OpenCV's FileStorage with `CameraMat`, `DistCoeff`, `ImageSize`."""

from functools import partial

from horizon_dl.calibration import opencv
from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree

NAME = "Autoware CameraMat"


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return "CameraMat" in tree


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera; `CameraExtrinsicMat` leads to a lidar and is of no use here."""
    note = "CameraExtrinsicMat leads to the lidar, not to the IMU: the mount is taken as stated, else as zero"
    notes = (note,) if fields.has("CameraExtrinsicMat") else ()
    return [
        Candidate(("CameraMat",), None, partial(_noted, one, notes))
        for one in opencv.candidates(fields, wanted)[:1]
    ]


def _noted(one: Candidate, notes: tuple[str, ...]) -> Found:
    found = one.build()
    return Found(found.camera, notes=(*found.notes, *notes))
