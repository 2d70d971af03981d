"""Settings of ORB-SLAM 2 and 3: `Camera.fx`, `Camera1.fx`, ..., and `Tbc` or `IMU.T_b_c1` to the IMU."""

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera, lens_named, size_of
from horizon_dl.calibration.rig_camera import rotation_of
from horizon_dl.errors import InputError

NAME = "ORB-SLAM settings"
CAMERAS = ("Camera", "Camera1", "Camera2")
TRANSFORMS = ("IMU.T_b_c1", "Tbc")
ORDER = {
    "pinhole": (),
    "radtan": ("k1", "k2", "p1", "p2", "k3"),
    "rational": ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    "kannala_brandt": ("k1", "k2", "k3", "k4"),
}


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return any(f"{name}.fx" in tree for name in CAMERAS)


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its cameras."""
    names = [name for name in CAMERAS if fields.has(f"{name}.fx")]
    return [_candidate(fields, name, wanted, name == names[0]) for name in names]


def _candidate(fields: Fields, name: str, wanted: Wanted, first: bool) -> Candidate:
    return Candidate((name,), None, lambda: _found(fields, name, wanted, first))


def _found(fields: Fields, name: str, wanted: Wanted, first: bool) -> Found:
    intrinsics = [fields.number(f"{name}.{key}") for key in ("fx", "fy", "cx", "cy")]
    size = size_of(
        fields, wanted.size, (("Camera.width", "Camera.height"), (f"{name}.width", f"{name}.height"))
    )
    lens = _lens(fields, name)
    camera = build_camera(fields, lens, size, intrinsics, _values(fields, name, lens))
    transform = next((each for each in TRANSFORMS if fields.has(each)), None)
    if transform is None or not first:
        return Found(camera)
    return Found(camera, rotation_of(fields, transform), transform)


def _lens(fields: Fields, name: str) -> str:
    """By `Camera.type`; version 2 and stereo files have none and mean the pinhole with its coefficients."""
    stated = fields.text("Camera.type") or "PinHole"
    if stated.lower() == "rectified":
        return "pinhole"
    lens = lens_named(fields, "Camera.type", stated)
    if lens != "pinhole":
        return lens
    if fields.has(f"{name}.k4"):
        return "rational"
    return "radtan" if any(fields.has(f"{name}.{key}") for key in ORDER["radtan"]) else "pinhole"


def _values(fields: Fields, name: str, lens: str) -> tuple[float, ...]:
    if lens not in ORDER:
        problem = f"has the lens {lens}, which ORB-SLAM does not know"
        raise InputError(fields.path, problem, "correct Camera.type")
    keys = [f"{name}.{key}" for key in ORDER[lens]]
    # Only Brown's coefficients may be left out.
    return tuple(fields.number(key) if lens == "kannala_brandt" or fields.has(key) else 0.0 for key in keys)
