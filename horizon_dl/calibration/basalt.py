"""Basalt's calibration JSON: all its cameras, and `T_imu_cam`."""

from collections.abc import Mapping
from pathlib import Path

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import rotation_from_quaternion

NAME = "Basalt calibration"
LENSES: dict[str, tuple[str, tuple[str, ...]]] = {
    "pinhole": ("pinhole", ()),
    "pinhole-radtan8": ("rational", ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")),
    "kb4": ("kannala_brandt", ("k1", "k2", "k3", "k4")),
    "ds": ("double_sphere", ("xi", "alpha")),
    "eucm": ("eucm", ("alpha", "beta")),
    "ucm": ("eucm", ("alpha",)),
    "fov": ("fov", ("w",)),
}


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    inner = tree.get("value0", tree)
    lenses = inner.get("intrinsics") if isinstance(inner, Mapping) else None
    return isinstance(lenses, list) and bool(lenses) and isinstance(lenses[0], Mapping)


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its cameras, named cam0, cam1, ..."""
    if "value0" in fields.content:
        fields = fields.section("value0")
    lenses, sizes = fields.get("intrinsics"), fields.get("resolution")
    poses = fields.content.get("T_imu_cam") or [None] * len(lenses)
    lists = all(isinstance(each, list) for each in (lenses, sizes, poses))
    if not lists or not 0 < len(lenses) == len(sizes) == len(poses) <= 100:
        raise InputError(
            fields.path, "does not have as many intrinsics as resolutions and poses", "complete it"
        )
    rows = zip(lenses, sizes, poses, strict=True)
    return [
        _candidate(f"cam{index}", fields.path, {"lens": lens, "size": size, "T_imu_cam": pose})
        for index, (lens, size, pose) in enumerate(rows)
    ]


def _candidate(name: str, path: Path, content: Tree) -> Candidate:
    fields = Fields(path, content, f"{name}.")
    return Candidate((name,), fields.sizes("size"), lambda: _found(fields))


def _found(fields: Fields) -> Found:
    lens = fields.section("lens")
    kind = lens.text("camera_type").lower()
    if kind not in LENSES:
        problem = f"camera_type is '{kind[:40]}', a lens model that is not known"
        raise InputError(fields.path, problem, "calibrate with " + ", ".join(LENSES))
    model, names = LENSES[kind]
    given = lens.section("intrinsics")
    values = [given.number(name) for name in names] + [1.0] * (kind == "ucm")  # its beta
    intrinsics = [given.number(name) for name in ("fx", "fy", "cx", "cy")]
    camera = build_camera(fields, model, fields.sizes("size"), intrinsics, values)
    if not fields.has("T_imu_cam"):
        return Found(camera)
    pose = fields.section("T_imu_cam")
    try:
        rotation = rotation_from_quaternion([pose.number(name) for name in ("qw", "qx", "qy", "qz")])
    except ValueError:
        raise fields.wrong("T_imu_cam", "a unit quaternion") from None
    return Found(camera, rotation, f"{fields.prefix}T_imu_cam")
