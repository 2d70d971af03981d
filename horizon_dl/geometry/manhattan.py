"""Which way is up, from the straight edges of one picture: verticals, and level edges at right angles.

The edges of buildings, rooms and furniture are mostly along three directions. Every edge is a draw from a
mixture: along one of the three, within a degree, or anything (after Coughlan and Yuille, Manhattan world,
ICCV 1999, here on line segments). The up direction is the likeliest of all, whatever the heading of the other
two.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.lines import LinePlanes
from horizon_dl.geometry.tilts import UpEstimate, estimate, roll_pitch_of, tilts

Floats = NDArray[np.float64]

MOST_EDGES = 100
LEAST_EDGES = 6
SD = np.radians(1.0)
"""By how much an edge's plane misses its direction."""
VERTICAL, LEVEL = 0.3, 0.2
"""Shares of the verticals, and of each of the two level directions; the rest is anything."""
WORTH = 0.25
"""What an edge counts: edges are broken into pieces, and several are of one thing."""
COARSE, FINE = np.radians(2.0), np.radians(0.25)
KEPT = 100
AZIMUTHS = 20
_PRIOR_ROLL, _PRIOR_PITCH = np.radians(12.0), np.radians(25.0)


def up_from_edges(planes: LinePlanes) -> UpEstimate | None:
    """Up and its doubt; None with too few edges.

    Args:
        planes: of the picture's edges. Cameras that are held within 45 degrees of upright.
    """
    if len(planes.normal) < LEAST_EDGES:
        return None
    longest = np.argsort(planes.length_rad)[::-1][:MOST_EDGES]
    normal = planes.normal[longest]
    weight = np.clip(planes.length_rad[longest] / np.radians(8.0), 0.2, 1.5) * WORTH
    ups = tilts(COARSE)
    vertical = _density(ups @ normal.T, SD + COARSE / 2)
    alone = np.log(VERTICAL * vertical + 1 - VERTICAL) @ weight + _prior(ups)
    kept = np.union1d(np.argsort(alone)[::-1][:KEPT], np.arange(0, len(ups), 9))
    coarse = np.full(len(ups), -np.inf)
    coarse[kept] = _likelihood(ups[kept], normal, weight, SD + COARSE / 2)
    best = ups[int(np.argmax(coarse))]
    near = tilts(FINE, roll_pitch_of(best), 1.5 * COARSE)
    fine = _likelihood(near, normal, weight, SD)
    within, elsewhere = estimate(near, fine), estimate(ups, coarse)
    # The coarse grid cannot see less than its own step.
    other = max(elsewhere.sd_rad**2 - (COARSE / 2) ** 2, 0.0)
    return UpEstimate(within.up_cam, float(np.sqrt(within.sd_rad**2 + other)))


def _likelihood(ups: Floats, normal: Floats, weight: Floats, sd: float) -> Floats:
    """(M,) log likelihoods of all edges, each under the best heading."""
    normal = normal.astype(np.float32)  # half the time, and far more exact than any edge
    vertical = VERTICAL * _density(ups.astype(np.float32) @ normal.T, sd)
    # Two level axes of each up direction: right of the camera, and ahead of it.
    ahead = np.array([0.0, 0.0, 1.0]) - ups[:, 2:] * ups
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    to_side, to_front = (
        np.cross(ups, ahead).astype(np.float32) @ normal.T,
        ahead.astype(np.float32) @ normal.T,
    )
    best = np.full(len(ups), -np.inf)
    for azimuth in np.arange(AZIMUTHS) * (np.pi / 2 / AZIMUTHS):
        c, s = float(np.cos(azimuth)), float(np.sin(azimuth))
        wide = float(np.hypot(sd, np.pi / 4 / AZIMUTHS))  # the headings are not tried more finely than that
        level = _density(c * to_side + s * to_front, wide) + _density(c * to_front - s * to_side, wide)
        total = np.log(vertical + LEVEL * level + (1 - VERTICAL - 2 * LEVEL)) @ weight
        np.maximum(best, total, out=best)
    return best + _prior(ups)


def _density(miss: NDArray[Any], sd: float) -> NDArray[Any]:
    """Of an edge along a direction, against that of any edge, whose miss is even over all sines."""
    density: NDArray[Any] = float(np.sqrt(2 / np.pi) / sd) * np.exp(np.square(miss) * (-0.5 / sd**2))
    return density


def _prior(ups: Floats) -> Floats:
    """People and robots hold cameras upright, and rather level."""
    roll = np.arctan2(-ups[:, 0], -ups[:, 1])
    pitch = np.arcsin(np.clip(ups[:, 2], -1, 1))
    return np.asarray(-0.5 * ((roll / _PRIOR_ROLL) ** 2 + (pitch / _PRIOR_PITCH) ** 2))
