"""COLMAP's cameras.txt. Its pixel (0, 0) has its centre at (0.5, 0.5); here pixel centres are integers."""

from horizon_dl.calibration.candidate import Candidate, Found, Size, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera
from horizon_dl.calibration.tree import COLMAP_LINES
from horizon_dl.errors import InputError

NAME = "COLMAP cameras.txt"
MODELS: dict[str, tuple[str, str]] = {
    "SIMPLE_PINHOLE": ("pinhole", "f cx cy"),
    "PINHOLE": ("pinhole", "fx fy cx cy"),
    "SIMPLE_RADIAL": ("radtan", "f cx cy k1"),
    "RADIAL": ("radtan", "f cx cy k1 k2"),
    "OPENCV": ("radtan", "fx fy cx cy k1 k2 p1 p2"),
    "FULL_OPENCV": ("rational", "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6"),
    "OPENCV_FISHEYE": ("kannala_brandt", "fx fy cx cy k1 k2 k3 k4"),
    "SIMPLE_RADIAL_FISHEYE": ("kannala_brandt", "f cx cy k1"),
    "RADIAL_FISHEYE": ("kannala_brandt", "f cx cy k1 k2"),
    "FOV": ("fov", "fx fy cx cy omega"),
}


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return COLMAP_LINES in tree


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its cameras, by their numbers."""
    return [_candidate(fields, line) for line in fields.content[COLMAP_LINES]]


def _candidate(fields: Fields, line: list[str]) -> Candidate:
    section = Fields(fields.path, {"size": line[2:4], "parameters": line[4:]}, f"camera {line[0]}: ")
    size = section.sizes("size")
    return Candidate((line[0], line[1]), size, lambda: _found(section, line[1], size))


def _found(fields: Fields, model: str, size: Size) -> Found:
    if model not in MODELS:
        problem = f"has the camera model {model[:40]}, which is not known"
        raise InputError(fields.path, problem, "reconstruct with one of " + ", ".join(MODELS))
    lens, names = MODELS[model]
    numbers = fields.numbers("parameters", len(names.split()))
    own = 3 if names.startswith("f ") else 4
    focal = (numbers[0], numbers[own - 3])
    intrinsics = (*focal, numbers[own - 2] - 0.5, numbers[own - 1] - 0.5)
    return Found(build_camera(fields, lens, size, intrinsics, numbers[own:]))
