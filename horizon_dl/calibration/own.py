"""The project's own camera.yaml.

Fields: `model` (a name in `geometry.lenses.registry`), `width`, `height`, `fx`, `fy`, `cx`, `cy` (pixels, of
the upright image), `distortion` (the lens's parameters in its order: k1, k2, p1, p2, k3 for radtan; may be
left out for pinhole); and those that every kind of file may have, see `read_calibration`.
"""

from horizon_dl.calibration.candidate import Candidate, Found, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.calibration.lens_names import build_camera
from horizon_dl.geometry.lenses.registry import LENSES

NAME = "camera.yaml"


def recognises(tree: Tree) -> bool:
    """Whether the fields are of this kind."""
    return "model" in tree or {"fx", "fy", "cx", "cy"} <= set(tree)


def candidates(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """Its one camera."""
    return [Candidate((NAME,), None, lambda: _camera(fields))]


def _camera(fields: Fields) -> Found:
    name = str(fields.get("model"))
    if name not in LENSES:
        raise fields.wrong("model", "one of " + ", ".join(LENSES))
    has_lens = bool(LENSES[name].parameters) or bool(fields.content.get("distortion"))
    size = fields.size("width"), fields.size("height")
    intrinsics = [fields.number(key) for key in ("fx", "fy", "cx", "cy")]
    return Found(
        build_camera(fields, name, size, intrinsics, fields.numbers("distortion") if has_lens else ())
    )
