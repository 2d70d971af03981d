"""Autoware's calibration: OpenCV's FileStorage with `CameraMat`, `DistCoeff`, `ImageSize`."""

from horizon_dl.calibration import opencv
from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree

NAME = "Autoware CameraMat"


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return "CameraMat" in tree


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera; `CameraExtrinsicMat` leads to a lidar and is of no use here."""
    (one,) = opencv.candidates(fields, wanted)
    note = "CameraExtrinsicMat leads to the lidar, not to the IMU: the mount is taken as stated, else as zero"
    notes = (note,) if fields.has("CameraExtrinsicMat") else ()
    return [Candidate(("CameraMat",), None, lambda: _noted(one.build(), notes))]


def _noted(found: Found, notes: tuple[str, ...]) -> Found:
    return Found(found.camera, notes=(*found.notes, *notes))
