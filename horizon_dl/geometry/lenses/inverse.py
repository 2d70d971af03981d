"""The inverse of a lens's radial profile on its inner branch, where it grows from zero."""

from collections.abc import Callable

import numpy as np

from horizon_dl.geometry.lenses.lens import Floats, Mask

Profile = Callable[[Floats], Floats]
TABLE = 4096
STEPS = 6


def first_turn(slope: Profile, upper: float) -> float:
    """Where the slope first falls to zero in (0, upper], by a scan and bisection; upper if nowhere.

    A polynomial's roots from its companion matrix fail for vanishing leading coefficients.
    """
    table = np.linspace(0.0, upper, TABLE)
    falling = np.flatnonzero(~(slope(table) > 0))
    if not len(falling):
        return upper
    last = max(int(falling[0]), 1)
    low, high = float(table[last - 1]), float(table[last])
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(np.array([middle]))[0] > 0 else (low, middle)
    return low


def invert(profile: Profile, slope: Profile, values: Floats, limit: float) -> tuple[Floats, Mask]:
    """Solve `profile(s) = value` for s in [0, limit), where the profile grows.

    Args:
        profile: from 0 at 0.
        slope: its derivative.
        values: (N,) not negative.
        limit: the end of the inner branch.

    Returns:
        (N,) s, and (N,) whether it was found.
    """
    table = np.linspace(0.0, limit, TABLE)
    s = np.interp(values, profile(table), table)
    for _ in range(STEPS):
        gradient = slope(s)
        step = (profile(s) - values) / np.where(np.abs(gradient) > 1e-6, gradient, np.inf)
        s = np.clip(s - step, 0.0, limit)
    found = np.abs(profile(s) - values) < 1e-7 * (1 + values)
    return s, found & (s < limit)


def invert_odd_polynomial(
    coefficients: tuple[float, ...], values: Floats, upper: float
) -> tuple[Floats, Mask, float]:
    """Solve `s (1 + c0 s^2 + c1 s^4 + ...) = value` on the inner branch.

    Args:
        coefficients: c0, c1, ...
        values: (N,) not negative.
        upper: largest s that is looked for.

    Returns:
        (N,) s; (N,) whether it was found; the end of the inner branch.
    """
    profile = odd_polynomial(coefficients)
    slope = profile.deriv()
    limit = first_turn(slope, upper)
    return *invert(profile, slope, values, limit), limit


def odd_polynomial(coefficients: tuple[float, ...]) -> np.polynomial.Polynomial:
    """`s (1 + c0 s^2 + c1 s^4 + ...)`."""
    odd = np.zeros(2 * len(coefficients) + 2)
    odd[1], odd[3::2] = 1.0, coefficients
    return np.polynomial.Polynomial(odd)
