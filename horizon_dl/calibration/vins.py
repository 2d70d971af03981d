"""VINS's camera files (camodocal): PINHOLE, KANNALA_BRANDT, MEI, and `extrinsicRotation` to the IMU."""

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera, size_of
from horizon_dl.calibration.rig_camera import rotation_of
from horizon_dl.errors import InputError

NAME = "VINS camera"
TRANSFORMS = ("extrinsicRotation", "body_T_cam0")
_BROWN = ("k1", "k2", "p1", "p2")
INTRINSICS = {
    "PINHOLE": ("fx", "fy", "cx", "cy"),
    "KANNALA_BRANDT": ("mu", "mv", "u0", "v0"),
    "MEI": ("gamma1", "gamma2", "u0", "v0"),
}


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return "model_type" in tree


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera."""
    return [Candidate((fields.text("camera_name") or "camera",), None, lambda: _found(fields, wanted))]


def _found(fields: Fields, wanted: Wanted) -> Found:
    model = fields.text("model_type").upper()
    if model not in INTRINSICS:
        problem = f"field 'model_type' is '{model[:40]}', a lens model that is not known"
        raise InputError(fields.path, problem, f"calibrate with {', '.join(INTRINSICS)}")
    projection = fields.section("projection_parameters")
    intrinsics = [projection.number(name) for name in INTRINSICS[model]]
    if model == "KANNALA_BRANDT":
        lens, values = "kannala_brandt", [projection.number(name) for name in ("k2", "k3", "k4", "k5")]
    else:
        bend = fields.section("distortion_parameters") if fields.has("distortion_parameters") else None
        lens, values = "radtan", [0.0 if bend is None else bend.number(name) for name in _BROWN]
    if model == "MEI":
        lens, values = "omni", [fields.section("mirror_parameters").number("xi"), *values]
    size = size_of(fields, wanted.size, (("image_width", "image_height"),))
    camera = build_camera(fields, lens, size, intrinsics, values)
    transform = next((name for name in TRANSFORMS if fields.has(name)), None)
    return Found(camera) if transform is None else Found(camera, rotation_of(fields, transform), transform)
