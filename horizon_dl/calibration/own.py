"""The project's own camera.yaml.

Fields: `model` (a name in `geometry.lenses.registry`), `width`, `height`, `fx`, `fy`, `cx`, `cy` (pixels, of
the upright image), `distortion` (the lens's parameters in its order: k1, k2, p1, p2, k3 for radtan; may be
left out for pinhole); and those that every kind of file may have, see `read_calibration`.
"""

import re

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera, lens_named
from horizon_dl.errors import InputError
from horizon_dl.geometry.lenses.registry import LENSES

NAME = "camera.yaml"
FIELDS = ("model", "width", "height", "fx", "fy", "cx", "cy", "distortion")
_MATTERS = re.compile(r"(dist|[kp]\d)", re.IGNORECASE)
"""How fields begin that change the rays; a note of the user's own may have any other name."""


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return "model" in tree or {"fx", "fy", "cx", "cy"} <= set(tree)


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera."""
    return [Candidate((NAME,), None, lambda: _camera(fields))]


def _camera(fields: Fields) -> Found:
    _check_names(fields)
    name = lens_named(fields, "model", str(fields.get("model")))
    has_lens = bool(LENSES[name].parameters) or bool(fields.content.get("distortion"))
    size = fields.size("width"), fields.size("height")
    intrinsics = [fields.number(key) for key in ("fx", "fy", "cx", "cy")]
    return Found(
        build_camera(fields, name, size, intrinsics, fields.numbers("distortion") if has_lens else ())
    )


def _check_names(fields: Fields) -> None:
    """InputError for a field of another name that would be left out, and seems to matter."""
    for name in fields.content:
        if name not in FIELDS and _MATTERS.match(name):
            hint = "known are " + ", ".join(FIELDS)
            raise InputError(fields.path, f"has a field '{name[:40]}', which is not known here", hint)
