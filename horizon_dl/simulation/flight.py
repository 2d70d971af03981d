"""A flight through an arena: smooth path with clearance, heading, tilt from acceleration."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from horizon_dl.simulation.layout import Arena

RATE_HZ = 200.0
CLEARANCE_M = 0.7  # kept to every wall and solid, at any height
LEG_CLEARANCE_M = 0.85  # of the straight legs, before their corners are rounded
CORNER_CLEARANCE_M = 1.2  # of the corners: rounding moves the path inwards by up to 0.45 m
WALL_CLEARANCE_M = 1.6  # of the corners to the walls, so that the view is seldom one bare wall
ROUNDING_S = 0.3
GRAVITY = 9.81
_ATTEMPTS = 20

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Flight:
    """States at `RATE_HZ`, from time 0.

    Attributes:
        place: (N, 3) metres in the world, x north, y west, z up.
        rpy_rad: (N, 3) roll, pitch, yaw of the body (forward, right, down) in north-east-down, rad.
    """

    place: Floats
    rpy_rad: Floats

    def at(self, time_s: float) -> tuple[Floats, Floats]:
        """Place (3,) and roll, pitch, yaw (3,) at a time, interpolated between neighbouring states."""
        position = min(max(time_s * RATE_HZ, 0.0), len(self.place) - 1.001)
        low = int(position)
        part = position - low
        blend = [(1 - part) * states[low] + part * states[low + 1] for states in (self.place, self.rpy_rad)]
        return blend[0], blend[1]


def _smooth(values: Floats, sigma_s: float) -> Floats:
    """Gaussian smoothing along time; the ends are held."""
    reach = int(4 * sigma_s * RATE_HZ)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / (sigma_s * RATE_HZ)) ** 2)
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="edge")
    columns = [np.convolve(column, kernel / kernel.sum(), mode="valid") for column in padded.T]
    return np.stack(columns, axis=1)


def _wander(rng: np.random.Generator, count: int, sigma_s: float, columns: int = 1) -> Floats:
    """Smooth random signals of unit standard deviation: (count, columns)."""
    noise = _smooth(rng.normal(0, 1, (count, columns)), sigma_s)
    scale = noise.std(axis=0)
    return noise / np.where(scale > 0, scale, 1.0)


def _leg_is_free(arena: Arena, start: Floats, end: Floats) -> bool:
    steps = np.linspace(0, 1, 60)[:, None]
    return bool(arena.clearance(start + steps * (end - start)).min() >= LEG_CLEARANCE_M)


def _room(arena: Arena) -> Floats:
    return np.array((arena.length_m, arena.width_m)) / 2 - WALL_CLEARANCE_M


def _next_waypoint(rng: np.random.Generator, arena: Arena, trail: list[Floats]) -> Floats | None:
    """A free point in sight of the last one, away from where the flight has been, no sharp turn back."""
    half = _room(arena)
    candidates = rng.uniform(-half, half, (120, 2))
    best, best_score = None, -np.inf
    for candidate in candidates[arena.clearance(candidates) >= CORNER_CLEARANCE_M]:
        leg = candidate - trail[-1]
        length = float(np.hypot(*leg))
        if not 1.8 <= length <= 7.0 or not _leg_is_free(arena, trail[-1], candidate):
            continue
        before = trail[-1] - trail[-2] if len(trail) > 1 else leg
        turn = np.arccos(np.clip(leg @ before / (length * np.hypot(*before)), -1, 1))
        nearest = min(float(np.hypot(*(candidate - seen))) for seen in trail[-8:])
        score = nearest - 4.0 * max(0.0, turn - 1.4) + rng.uniform(0, 1.5)
        if score > best_score:
            best, best_score = candidate, score
    return best


def _legs(rng: np.random.Generator, arena: Arena, length_m: float) -> Floats | None:
    half = _room(arena)
    starts = rng.uniform(-half, half, (200, 2))
    free = starts[arena.clearance(starts) >= CORNER_CLEARANCE_M]
    if not len(free):
        return None
    trail, done = [free[0]], 0.0
    while done < length_m:
        point = _next_waypoint(rng, arena, trail)
        if point is None and len(trail) < 2:
            return None
        if point is None:  # a dead end: back to where it came from
            point = trail[-2]
        done += float(np.hypot(*(point - trail[-1])))
        trail.append(point)
    return np.array(trail)


def _along(legs: Floats, travelled_m: Floats) -> Floats:
    lengths = np.hypot(*np.diff(legs, axis=0).T)
    corners = np.concatenate(([0.0], np.cumsum(lengths)))
    return np.stack([np.interp(travelled_m, corners, axis) for axis in legs.T], axis=1)


def _heading(rng: np.random.Generator, velocity: Floats) -> Floats:
    """Yaw (N,): where it flies, looking about by 20 degrees; continuous."""
    direction = _smooth(velocity, 0.4)
    yaw = np.unwrap(np.arctan2(-direction[:, 1], direction[:, 0]))
    yaw += np.deg2rad(20) * _wander(rng, len(yaw), 1.0)[:, 0]
    return _smooth(yaw[:, None], 0.8)[:, 0]


def _tilt(rng: np.random.Generator, acceleration: Floats, yaw: Floats) -> tuple[Floats, Floats]:
    """Roll and pitch (N,) that give the acceleration, with 1.2 degrees of unrest; at most 15 degrees."""
    c, s = np.cos(yaw), np.sin(yaw)
    north, east = acceleration[:, 0], -acceleration[:, 1]
    forward, right = north * c + east * s, -north * s + east * c
    unrest = np.deg2rad(1.2) * _wander(rng, len(yaw), 0.12, 2)
    limit = np.deg2rad(15)
    roll = np.clip(np.arctan2(right, GRAVITY) + unrest[:, 0], -limit, limit)
    return roll, np.clip(np.arctan2(-forward, GRAVITY) + unrest[:, 1], -limit, limit)


def _heights(rng: np.random.Generator, count: int, bounds_m: tuple[float, float]) -> Floats:
    low, high = bounds_m
    swing = np.tanh(1.6 * _wander(rng, count, 1.4)[:, 0])
    return (low + high) / 2 + (high - low) / 2 * 0.98 * swing


def plan_flight(
    rng: np.random.Generator, arena: Arena, duration_s: float, height_m: tuple[float, float]
) -> Flight | None:
    """A random flight of about 1.2 m/s that keeps `CLEARANCE_M` to everything; None if there is no room.

    Args:
        rng: of the path.
        arena: flown through.
        duration_s: of the flight.
        height_m: lowest and highest place.
    """
    count = int(duration_s * RATE_HZ) + 2
    for _ in range(_ATTEMPTS):
        speed = 1.25 * (1 + 0.35 * np.clip(_wander(rng, count, 0.8)[:, 0], -1.3, 1.3))
        travelled = np.cumsum(speed) / RATE_HZ
        legs = _legs(rng, arena, float(travelled[-1]))
        if legs is None:
            continue
        path = _smooth(_along(legs, travelled), ROUNDING_S)
        if arena.clearance(path).min() < CLEARANCE_M:
            continue
        velocity = np.gradient(path, 1 / RATE_HZ, axis=0)
        yaw = _heading(rng, velocity)
        roll, pitch = _tilt(rng, np.gradient(velocity, 1 / RATE_HZ, axis=0), yaw)
        place = np.column_stack((path, _heights(rng, count, height_m)))
        return Flight(place, np.column_stack((roll, pitch, yaw)))
    return None


def fitting_flight(
    rng: np.random.Generator, arena: Arena, duration_s: float, height_m: tuple[float, float]
) -> tuple[Arena, Flight]:
    """A flight through an arena; solids are taken out, the last first, until one fits. See `plan_flight`."""
    while True:
        flight = plan_flight(rng, arena, duration_s, height_m)
        if flight is not None:
            return arena, flight
        arena = replace(arena, solids=arena.solids[:-1])
