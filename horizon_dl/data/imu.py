"""Which way is up, from gyroscope and accelerometer alone.

A complementary filter with integral bias (Mahony, Hamel, Pflimlin: Nonlinear complementary filters on the
special orthogonal group, 2008) on the one direction that the horizon needs. Plain floats: arrays of three
cost more.
"""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]

GRAVITY_M_S2 = 9.81
CORRECTION_PER_S = 0.5
"""How fast the accelerometer pulls the estimate, 1/s: slower than manoeuvres, faster than drift."""

BIAS_PER_S2 = 0.05
ACCEPTED_M_S2 = 1.5
"""An accelerometer that differs more from gravity feels a manoeuvre and is not listened to."""

LONGEST_STEP_S = 1.0
"""What happens in a longer gap nobody knows; no frame there gets an attitude."""

STILL_S = 0.5
STILL_RATE_RAD_S = 0.01
STILL_ACCELERATION_M_S2 = 0.1
MAX_BIAS_RAD_S = 0.2


def estimate_up(times_s: Floats, rates: Floats, accelerations: Floats) -> Floats:
    """The world's up as unit vectors in the IMU's axes.

    Each sample uses the past only, but for the gyroscope's bias at the start: the mean rate of the first
    second if the IMU stands still then, else what a first pass over all samples ends with.

    Args:
        times_s: (N,) sorted, s.
        rates: (N, 3) gyroscope, rad/s.
        accelerations: (N, 3) accelerometer (specific force: points up at rest), m/s^2.

    Returns:
        (N, 3) unit vectors.
    """
    bias = still_bias(times_s, rates, accelerations)
    if bias is None:
        _, bias = _filter(times_s, rates, accelerations, (0.0, 0.0, 0.0))
    ups, _ = _filter(times_s, rates, accelerations, bias)
    return np.array(ups)


def still_bias(times_s: Floats, rates: Floats, accelerations: Floats) -> Vector | None:
    """Mean rate (rad/s) of the first second if the IMU stands still then, else None.

    Running motors shake an IMU that stands still, so means of two halves are compared, not deviations.
    """
    first = times_s < times_s[0] + STILL_S
    second = ~first & (times_s < times_s[0] + 2 * STILL_S)
    if not second.any():
        return None
    halves = [(rates[part].mean(axis=0), accelerations[part].mean(axis=0)) for part in (first, second)]
    (rate_1, force_1), (rate_2, force_2) = halves
    still = (
        np.linalg.norm(rate_1 - rate_2) < STILL_RATE_RAD_S
        and np.linalg.norm(force_1 - force_2) < STILL_ACCELERATION_M_S2
        and np.linalg.norm(rate_1) < MAX_BIAS_RAD_S
    )
    return _vector((rate_1 + rate_2) / 2) if still else None


def _filter(
    times_s: Floats, rates: Floats, accelerations: Floats, bias: Vector
) -> tuple[list[Vector], Vector]:
    """Up at every sample, and the bias at the end."""
    up = _unit(_vector(accelerations[times_s < times_s[0] + STILL_S].mean(axis=0)))
    ups = [up]
    steps = np.minimum(np.diff(times_s), LONGEST_STEP_S).tolist()
    # The mean of two samples is the rate between them.
    middle_rates = ((rates[1:] + rates[:-1]) / 2).tolist()
    for dt, rate, acceleration in zip(steps, middle_rates, accelerations[1:].tolist(), strict=True):
        up, bias = _step(up, bias, dt, rate, acceleration)
        ups.append(up)
    return ups, bias


def _step(up: Vector, bias: Vector, dt: float, rate: Vector, acceleration: Vector) -> tuple[Vector, Vector]:
    """One sample: turn against the body's rotation, then towards the accelerometer."""
    force = math.sqrt(sum(a * a for a in acceleration))
    error: Vector = (0.0, 0.0, 0.0)
    if abs(force - GRAVITY_M_S2) < ACCEPTED_M_S2:
        error = _cross(_unit(acceleration), up)
    bias = _add(bias, error, -BIAS_PER_S2 * dt)
    turn = _scale(_add(_add(rate, bias, -1.0), error, CORRECTION_PER_S), dt)
    return _rotate_back(up, turn), bias


def _rotate_back(vector: Vector, turn: Vector) -> Vector:
    """The world-fixed vector after the body turned by the rotation vector `turn` (Rodrigues, exact)."""
    angle = math.sqrt(sum(t * t for t in turn))
    if angle < 1e-12:
        return vector
    axis = _scale(turn, 1 / angle)
    c, s = math.cos(angle), math.sin(angle)
    along = sum(a * v for a, v in zip(axis, vector, strict=True)) * (1 - c)
    turned = _add(_scale(vector, c), _cross(axis, vector), -s)
    return _unit(_add(turned, axis, along))


def _vector(array: Floats) -> Vector:
    return float(array[0]), float(array[1]), float(array[2])


def _add(a: Vector, b: Vector, factor: float) -> Vector:
    """`a + factor b`."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


def _scale(a: Vector, factor: float) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _unit(v: Vector) -> Vector:
    norm = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) or 1.0
    return v[0] / norm, v[1] / norm, v[2] / norm
