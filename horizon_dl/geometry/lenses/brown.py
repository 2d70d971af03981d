"""Brown's radial and tangential distortion (1966), and OpenCV's rational form of it with three more terms.

The inverse starts from the radial profile inverted on its inner branch and is finished by Newton steps on the
forward model itself: fixed-point iterations are far off for strong lenses.
"""

from functools import lru_cache

import numpy as np

from horizon_dl.geometry.lenses.inverse import first_turn, invert
from horizon_dl.geometry.lenses.lens import FREE, Floats, Lens, Mask, Values, divided, with_depth

MAX_TANGENT = 20.0
"""87 degrees off the axis: farther out a plane at z = 1 means little."""
NEWTON_STEPS = 12
NEWTON_ERROR = 1e-12


def distort(plane: Floats, values: Values) -> tuple[Floats, Floats]:
    """Points (N, 2) on the plane z = 1 to image points (N, 2), and the derivatives (N, 2, 2) of it.

    Args:
        plane: x, y.
        values: k1, k2, p1, p2 and, where there are any, k3, k4, k5, k6.
    """
    k1, k2, p1, p2, k3, k4, k5, k6 = (*values, *[0.0] * 8)[:8]
    x, y = plane.T
    r2 = x * x + y * y
    upper, lower = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), 1 + r2 * (k4 + r2 * (k5 + r2 * k6))
    gain = upper / lower
    bend = (k1 + r2 * (2 * k2 + r2 * 3 * k3) - gain * (k4 + r2 * (2 * k5 + r2 * 3 * k6))) / lower
    u = x * gain + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * gain + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    cross = 2 * x * y * bend + 2 * p1 * x + 2 * p2 * y
    u_x = gain + 2 * x * x * bend + 2 * p1 * y + 6 * p2 * x
    v_y = gain + 2 * y * y * bend + 6 * p1 * y + 2 * p2 * x
    derivatives = np.stack([np.stack([u_x, cross], -1), np.stack([cross, v_y], -1)], -2)
    return np.stack([u, v], -1), derivatives


def undistort(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Points (N, 2) on the plane z = 1 of image points (N, 2), and where they lie on the inner branch."""
    limit = reach(values)
    profile, slope = _profile(values)
    radius_image = np.linalg.norm(image, axis=-1)
    radius, found = invert(profile, slope, radius_image, limit)
    scale = np.where(radius_image > 1e-12, radius / np.maximum(radius_image, 1e-12), 1.0)
    plane = image * scale[:, None]
    determinant = np.ones(len(plane))
    for _ in range(NEWTON_STEPS):
        now, ((u_x, u_y), (v_x, v_y)) = _moved(plane, values)
        determinant = u_x * v_y - u_y * v_x
        error_u, error_v = (now - image).T
        if np.nan_to_num(np.abs(now - image)).max(initial=0.0) < NEWTON_ERROR:
            break
        safe = np.where(np.abs(determinant) > 1e-9, determinant, np.inf)
        step = np.stack([v_y * error_u - u_y * error_v, u_x * error_v - v_x * error_u], -1) / safe[:, None]
        plane = np.clip(plane - step, -2 * MAX_TANGENT, 2 * MAX_TANGENT)
    return plane, found & (determinant > 0) & (np.linalg.norm(plane, axis=-1) < limit)


@lru_cache(maxsize=64)
def reach(values: Values) -> float:
    """The radius on the plane z = 1 where the profile stops growing: farther out two rays share a pixel."""
    return first_turn(_profile(values)[1], MAX_TANGENT)


def project(points: Floats, values: Values) -> Floats:
    """Image points (N, 2); NaN for points that are not in front or beyond the fold."""
    plane = divided(points[:, :2], points[:, 2], points[:, 2] > 0)
    inside = np.linalg.norm(plane, axis=-1) <= reach(values)
    return np.where(inside[:, None], distort(np.where(inside[:, None], plane, 0.0), values)[0], np.nan)


def unproject(image: Floats, values: Values) -> tuple[Floats, Mask]:
    """Rays (N, 3) and where they exist."""
    plane, valid = undistort(image, values)
    return with_depth(plane, 1.0), valid


def _moved(plane: Floats, values: Values) -> tuple[Floats, Floats]:
    image, derivatives = distort(plane, values)
    return image, derivatives.transpose(1, 2, 0)


def _profile(values: Values) -> tuple["_Radial", "_Radial"]:
    return _Radial(values, 0), _Radial(values, 1)


class _Radial:
    """The radial profile `r -> r gain(r)`, or its slope; NaN beyond a pole of the rational form."""

    def __init__(self, values: Values, derivative: int) -> None:
        k1, k2, _, _, *more = (*values, *[0.0] * 8)[:8]
        self._values, self._derivative = (k1, k2, 0.0, 0.0, *more), derivative
        self._lower = more[1:]

    def __call__(self, radius: Floats) -> Floats:
        r2 = radius * radius
        k4, k5, k6 = self._lower
        lower = 1 + r2 * (k4 + r2 * (k5 + r2 * k6))
        image, derivatives = distort(np.stack([radius, np.zeros_like(radius)], -1), self._values)
        wanted = derivatives[:, 0, 0] if self._derivative else image[:, 0]
        return np.where(lower > 1e-9, wanted, np.nan)


_RADTAN = dict.fromkeys(("k1", "k2", "p1", "p2", "k3"), FREE)
RADTAN = Lens(_RADTAN, 0, project, unproject)
RATIONAL = Lens(_RADTAN | dict.fromkeys(("k4", "k5", "k6"), FREE), 0, project, unproject)
