"""Every way to read an attitude, and how much each differs from the stated one."""

from collections.abc import Iterator
from itertools import permutations, product

import numpy as np

from horizon_dl.data.convention import Convention
from horizon_dl.geometry.axes import frd_from_axes

USUAL_BODIES = ("frd", "flu", "rdf", "rub", "ruf")
UPS = ("z", "-z", "y", "-y", "x", "-x")


def conventions(stated: Convention, quaternions: bool) -> Iterator[Convention]:
    """All conventions, left-handed axes among them: they are what a mirrored pose looks like."""
    units = ("rad",) if quaternions else ("rad", "deg")
    orders = ("wxyz", "xyzw") if quaternions else (stated.order,)
    bodies = ["".join(axes) for each in product("fb", "rl", "du") for axes in permutations(each)]
    for unit, order, inverse, body, up in product(units, orders, (False, True), bodies, UPS):
        yield Convention(body, up, order, unit, inverse)  # type: ignore[arg-type]


def changes(one: Convention, stated: Convention, quaternions: bool) -> float:
    """How much a convention differs from the stated one; simple explanations are preferred."""
    right_handed = np.linalg.det(frd_from_axes(one.body, left_handed=True)) > 0
    body = 1.0 if one.body in USUAL_BODIES else 2.5 if right_handed else 3.5
    return (
        (body if one.body != stated.body else 0.0)
        + (one.up != stated.up) * (0.9 if one.up in ("z", "-z", "y") else 1.5)
        + (quaternions and one.order != stated.order)
        + (not quaternions and one.unit != stated.unit)
        + 1.5 * (one.inverse != stated.inverse)
    )
