"""The camera's mount error from straight edges: the up direction that the scene's own verticals share.

An upright edge (wall, door, post) and the camera lie in a plane that holds the world's up. So every straight
edge votes for the mounts under which the recorded attitude puts up into its plane; edges that are no
verticals scatter their votes. Edges that are level in the world give a second opinion: under the right mount
their directions agree modulo 90 degrees, as those of floors, doors and boards in a building do.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy
from horizon_dl.geometry.lines import LinePlanes

Floats = NDArray[np.float64]

GRID = np.radians(np.arange(-10.0, 10.01, 0.5))
"""Corrections of roll and of pitch that are tried, rad."""
UPRIGHT = np.radians(1.0)
"""A vertical's plane misses up by less than this; the vote falls off with the square."""
LEAST_FRAMES = 5
RESAMPLES, PARTS = 100, 10
AZIMUTH_BINS = 90
_SMOOTHING = ((-3, 0.25), (-2, 0.5), (-1, 0.75), (0, 1.0), (1, 0.75), (2, 0.5), (3, 0.25))


@dataclass(frozen=True)
class Angle:
    """One angle of the mount, rad.

    Attributes:
        correction: to be added to the stated one.
        sd: standard deviation, by resampling parts of the recording. Errors of the lens calibration and walls
            that lean are not in it.
        at_limit: the best correction is the largest that was tried.
    """

    correction: float
    sd: float
    at_limit: bool = False


@dataclass(frozen=True)
class MountFit:
    """What the edges say of the mount.

    Attributes:
        roll, pitch: by the verticals.
        level_pitch: the pitch correction by the level edges alone, rad, the roll being that of the verticals;
            None where their best is the largest that was tried.
        frames: that had edges and an attitude.
        edges: in all of them.
    """

    roll: Angle
    pitch: Angle
    level_pitch: float | None
    frames: int
    edges: int


def fit_mount(
    planes: Sequence[LinePlanes], up_cam: Sequence[Any], mount_rpy_rad: tuple[float, float, float]
) -> MountFit | None:
    """The mount's errors of roll and pitch; None with too few frames.

    Args:
        planes: of each frame's edges.
        up_cam: (3,) of each frame, under the stated mount.
        mount_rpy_rad: the stated mount.
    """
    used = [index for index, one in enumerate(planes) if len(one.normal)]
    if len(used) < LEAST_FRAMES:
        return None
    normal = np.concatenate([planes[index].normal for index in used])
    weight = np.concatenate([planes[index].length_rad for index in used])
    frame = np.repeat(np.arange(len(used)), [len(planes[index].normal) for index in used])
    up = np.array([up_cam[index] for index in used], np.float64)
    votes = _vertical_votes(normal, weight, frame, up, mount_rpy_rad)
    best = _peak(votes.sum(axis=0))
    sd = _spread(votes)
    roll, pitch = (Angle(c, s, bool(abs(c) >= GRID[-1])) for c, s in zip(best, sd, strict=True))
    level = [
        _agreement(normal, weight, frame, _turned(up, mount_rpy_rad, roll.correction, shift)[frame])
        for shift in GRID.tolist()
    ]
    place = int(np.argmax(level))
    inside = 0 < place < len(GRID) - 1
    level_pitch = _refined(np.array(level), place) if inside else None
    return MountFit(roll, pitch, level_pitch, len(used), len(normal))


def corrected_up(
    up_cam: Floats, mount_rpy_rad: tuple[float, float, float], roll: float, pitch: float
) -> Floats:
    """(N, 3) up directions with `roll` and `pitch` added to the mount, all rad."""
    return _turned(up_cam, mount_rpy_rad, roll, pitch)


def _turned(up: Floats, mount: tuple[float, float, float], roll: float, pitch: float) -> Floats:
    stated = rotation_from_rpy(*mount)
    right = rotation_from_rpy(mount[0] + roll, mount[1] + pitch, mount[2])
    return np.asarray(up @ (OPTICAL_FROM_FRD @ right.T @ stated @ OPTICAL_FROM_FRD.T).T)


def _vertical_votes(
    normal: Floats, weight: Floats, frame: NDArray[np.int64], up: Floats, mount: tuple[float, float, float]
) -> Floats:
    """(frames, rolls, pitches) sum of the votes."""
    votes = np.zeros((len(up), len(GRID), len(GRID)))
    for i, roll in enumerate(GRID.tolist()):
        for j, pitch in enumerate(GRID.tolist()):
            miss = np.einsum("ij,ij->i", normal, _turned(up, mount, roll, pitch)[frame])
            vote = weight * np.maximum(0.0, 1.0 - np.square(miss / UPRIGHT))
            votes[:, i, j] = np.bincount(frame, vote, len(up))
    return votes


def _agreement(normal: Floats, weight: Floats, frame: NDArray[np.int64], up: Floats) -> float:
    """How well edges agree modulo 90 degrees in azimuth, each frame by itself, if all were level.

    Args:
        normal: (N, 3), `weight` (N,), `frame` (N,), of the edges.
        weight: see above.
        frame: see above.
        up: (N, 3) of each edge's frame.
    """
    direction = np.cross(normal, up)
    level = np.linalg.norm(direction, axis=1)
    # Verticals have no azimuth, and edges in the horizon's plane have any.
    use = (level > np.sin(np.radians(6))) & (np.abs(np.einsum("ij,ij->i", normal, up)) > np.radians(8))
    ahead = np.array([0.0, 0.0, 1.0]) - up[:, 2:] * up
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    across = np.einsum("ij,ij->i", direction, np.cross(up, ahead))
    azimuth = np.arctan2(across, np.einsum("ij,ij->i", direction, ahead)) % (np.pi / 2)
    bins = np.minimum((azimuth / (np.pi / 2) * AZIMUTH_BINS).astype(np.int64), AZIMUTH_BINS - 1)
    frames = int(frame.max()) + 1
    counts = np.bincount(
        (frame * AZIMUTH_BINS + bins)[use], (weight * level)[use], frames * AZIMUTH_BINS
    ).reshape(frames, AZIMUTH_BINS)
    smooth = sum(share * np.roll(counts, shift, axis=1) for shift, share in _SMOOTHING)
    return float(np.max(smooth, axis=1).sum())


def _peak(votes: Floats) -> tuple[float, float]:
    """Roll and pitch of the most votes, rad, between the grid's points."""
    i, j = (int(k) for k in np.unravel_index(np.argmax(votes), votes.shape))
    return _refined(votes[:, j], i), _refined(votes[i], j)


def _refined(votes: Floats, place: int) -> float:
    """The top of the parabola through a maximum and its neighbours."""
    if not 0 < place < len(votes) - 1:
        return float(GRID[place])
    before, top, after = votes[place - 1 : place + 2].tolist()
    bend = before - 2 * top + after
    return float(GRID[place] + (0.5 * (before - after) / bend if bend else 0.0) * (GRID[1] - GRID[0]))


def _spread(votes: Floats) -> tuple[float, float]:
    """Standard deviations of the peak when parts of the recording are drawn anew (block bootstrap)."""
    draws = np.random.default_rng(0)
    parts = np.array([part.sum(axis=0) for part in np.array_split(votes, min(PARTS, len(votes)))])
    peaks = []
    for _ in range(RESAMPLES):
        times = np.bincount(draws.integers(0, len(parts), len(parts)), minlength=len(parts))
        peaks.append(_peak(np.tensordot(times.astype(np.float64), parts, axes=1)))
    roll, pitch = np.std(np.array(peaks), axis=0).tolist()
    return roll, pitch
