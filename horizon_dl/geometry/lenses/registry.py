"""Every lens model by its name. A new one is a file with a `LENS` and a line here."""

from horizon_dl.geometry.lenses import (
    brown,
    double_sphere,
    extended_unified,
    field_of_view,
    kannala_brandt,
    omnidirectional,
    pinhole,
)
from horizon_dl.geometry.lenses.lens import Lens

LENSES: dict[str, Lens] = {
    "pinhole": pinhole.LENS,
    "radtan": brown.RADTAN,
    "rational": brown.RATIONAL,
    "kannala_brandt": kannala_brandt.LENS,
    "double_sphere": double_sphere.LENS,
    "eucm": extended_unified.LENS,
    "omni": omnidirectional.LENS,
    "fov": field_of_view.LENS,
}
