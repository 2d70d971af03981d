"""The free heading nearest to a desired one."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.ranging.sectors import FreeDistances, Outcome


@dataclass(frozen=True)
class Heading:
    """A heading in which a vehicle fits.

    Attributes:
        bearing_rad: clockwise from straight ahead, as the sectors' bearings.
        free_m: ground free for the vehicle's whole width along it; inf where no obstacle is in the way.
    """

    bearing_rad: float
    free_m: float


def free_heading(
    found: FreeDistances,
    wanted_rad: float,
    radius_m: float,
    needed_m: float,
    sigmas: float = 1.0,
) -> Heading | None:
    """The middle of the sector nearest to `wanted_rad` along which a disc of `radius_m` moves `needed_m`.

    A swath as wide as the vehicle must hold no obstacle. Sectors that are unknown, or have an obstacle but no
    metres, are taken for blocked at `needed_m`; a sector whose obstacle covers the nearest visible ground is
    never chosen, as nobody knows how near it is.

    Args:
        found: sectors in order of their bearings.
        wanted_rad: bearing.
        radius_m: half the width that the vehicle needs, positive.
        needed_m: how far it must get, more than `radius_m`.
        sigmas: every obstacle is taken this many standard deviations nearer.

    Returns:
        None if there is none: the paper then climbs outdoors and turns indoors.

    Raises:
        ValueError: the lengths make no sense.

    Example:
        >>> from horizon_dl.ranging.sectors import no_distances
        >>> free_heading(no_distances(np.zeros(3, np.float32)), 0.0, 0.3, 2.0) is None
        True
    """
    if not 0 < radius_m < needed_m:
        raise ValueError(f"needs 0 < radius ({radius_m} m) < needed distance ({needed_m} m)")
    free_m = swath_m(found, radius_m, needed_m, sigmas)
    covered = (found.outcome == Outcome.OBSTACLE) & ~found.contact_seen
    fits = (free_m >= needed_m) & (found.outcome != Outcome.UNKNOWN) & ~covered
    if not fits.any():
        return None
    away = np.abs(np.remainder(found.bearing_rad - wanted_rad + math.pi, 2 * math.pi) - math.pi)
    # Of two that are equally near, the one with more room.
    best = min(np.flatnonzero(fits).tolist(), key=lambda i: (round(float(away[i]), 6), -float(free_m[i])))
    return Heading(float(found.bearing_rad[best]), float(free_m[best]))


def swath_m(
    found: FreeDistances, radius_m: float, needed_m: float, sigmas: float = 1.0
) -> NDArray[np.float64]:
    """(sectors,) how far a disc moves along each bearing before it touches anything, m; inf for never.

    A point at distance d and angle a off the heading is touched iff `d sin|a| < radius`, after
    `d cos a - sqrt(radius^2 - (d sin a)^2)`.
    """
    point_m = _nearest_point_m(found, needed_m, sigmas)
    off = found.bearing_rad[None].astype(np.float64) - found.bearing_rad[:, None]
    blocked = np.isfinite(point_m)
    along = np.where(blocked, point_m, 0.0)[None] * np.cos(off)
    aside = np.where(blocked, point_m, 0.0)[None] * np.sin(off)
    touched = blocked[None] & (np.abs(aside) < radius_m) & (along > 0)
    contact = along - np.sqrt(np.maximum(radius_m**2 - aside**2, 0.0))
    return np.asarray(np.where(touched, np.maximum(contact, 0.0), np.inf).min(axis=1))


def _nearest_point_m(found: FreeDistances, needed_m: float, sigmas: float) -> NDArray[np.float64]:
    """(sectors,) where each sector's obstacle is taken to be; inf for none."""
    near = found.distance_m.astype(np.float64) - sigmas * np.nan_to_num(found.sd_m)
    in_doubt = (found.outcome == Outcome.UNKNOWN) | np.isnan(near)
    return np.where(in_doubt, needed_m, np.maximum(near, 0.0))
