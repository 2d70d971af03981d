"""The camera's mount error from straight edges: the up direction that the scene's own verticals share.

An upright edge (wall, door, post) and the camera lie in a plane that holds the world's up. So every straight
edge votes for the mounts under which the recorded attitude puts up into its plane; edges that are no
verticals scatter their votes. Edges that are level in the world give a second opinion: under the right mount
their directions agree modulo 90 degrees, as those of floors, doors and boards in a building do.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy, rpy_from_rotation
from horizon_dl.geometry.lines import LinePlanes

Floats = NDArray[np.float64]

COARSE = np.radians(np.arange(-36.0, 36.01, 2.0))
FINE = np.radians(np.arange(-4.0, 4.01, 0.5))
"""Corrections of roll and of pitch that are tried, rad: all over, then around the best."""
COARSE_UPRIGHT, UPRIGHT = np.radians(3.0), np.radians(1.0)
"""A vertical's plane misses up by less than this; the vote falls off with the square."""
FINE_STEP = float(FINE[1] - FINE[0])
LEVEL = np.radians(np.arange(-10.0, 10.01, 0.5))
AGREES_RAD, LEAST_SD_RAD = math.radians(1.5), math.radians(0.1)
LEAST_FRAMES = 5
RESAMPLES, PARTS = 100, 10
AZIMUTH_BINS = 90
_SMOOTHING = ((-3, 0.25), (-2, 0.5), (-1, 0.75), (0, 1.0), (1, 0.75), (2, 0.5), (3, 0.25))


@dataclass(frozen=True)
class Angle:
    """One angle by which the mount is off, rad, about the camera's own axes (forward, or right).

    Attributes:
        correction: by which the camera is turned from where the stated mount has it.
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
        roll: by the verticals.
        pitch: by the verticals, and by the level edges where they agree.
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


def fit_mount(planes: Sequence[LinePlanes], up_cam: Sequence[Any]) -> MountFit | None:
    """The mount's errors of roll and pitch; None with too few frames.

    Args:
        planes: of each frame's edges.
        up_cam: (3,) of each frame, under the stated mount.
    """
    used = [index for index, one in enumerate(planes) if len(one.normal)]
    if len(used) < LEAST_FRAMES:
        return None
    normal = np.concatenate([planes[index].normal for index in used])
    weight = np.concatenate([planes[index].length_rad for index in used])
    frame = np.repeat(np.arange(len(used)), [len(planes[index].normal) for index in used])
    up = np.array([up_cam[index] for index in used], np.float64)
    edges = _Edges(normal, weight, frame, up)
    rough = edges.votes(COARSE, COARSE, COARSE_UPRIGHT)
    about = _peak(rough.sum(axis=0), COARSE, COARSE)
    rolls, pitches = (FINE + round(angle / FINE_STEP) * FINE_STEP for angle in about)
    votes = edges.votes(rolls, pitches, UPRIGHT)
    best = _peak(votes.sum(axis=0), rolls, pitches)
    sd = np.hypot(_spread(votes, rolls, pitches), _leaps(rough))
    roll, pitch = (Angle(c, s, bool(abs(c) >= COARSE[-1])) for c, s in zip(best, sd.tolist(), strict=True))
    level = _level_pitch(edges, roll.correction, pitch.correction)
    level_pitch = None if level is None else level.correction
    return MountFit(roll, _both(pitch, level), level_pitch, len(used), len(normal))


def corrected_up(up_cam: Floats, roll: float, pitch: float) -> Floats:
    """(N, 3) up directions in a camera that is turned by `roll` and `pitch`, rad, about its own axes."""
    turn = rotation_from_rpy(roll, pitch, 0.0)
    return np.asarray(up_cam @ (OPTICAL_FROM_FRD @ turn @ OPTICAL_FROM_FRD.T))


def corrected_mount(
    mount_rpy_rad: tuple[float, float, float], roll: float, pitch: float
) -> tuple[float, float, float]:
    """The mount, roll, pitch and yaw in the body, of a camera that is turned as of `corrected_up`."""
    return rpy_from_rotation(rotation_from_rpy(*mount_rpy_rad) @ rotation_from_rpy(roll, pitch, 0.0))


@dataclass(frozen=True)
class _Edges:
    """All edges (N, ...) with the number of their frame, and up in the frames under the stated mount."""

    normal: Floats
    weight: Floats
    frame: NDArray[np.int64]
    up: Floats

    def votes(self, rolls: Floats, pitches: Floats, tolerance: float) -> Floats:
        """(frames, rolls, pitches) sum of the verticals' votes."""
        votes = np.zeros((len(self.up), len(rolls), len(pitches)))
        for i, roll in enumerate(rolls.tolist()):
            for j, pitch in enumerate(pitches.tolist()):
                up = corrected_up(self.up, roll, pitch)[self.frame]
                miss = np.einsum("ij,ij->i", self.normal, up)
                vote = self.weight * np.maximum(0.0, 1.0 - np.square(miss / tolerance))
                votes[:, i, j] = np.bincount(self.frame, vote, len(self.up))
        return votes

    def agreement(self, roll: float, pitch: float) -> Floats:
        """(frames,) how well the level edges agree under a mount."""
        up = corrected_up(self.up, roll, pitch)
        return _agreement(self.normal, self.weight, self.frame, up[self.frame])


def _level_pitch(edges: _Edges, roll: float, pitch: float) -> Angle | None:
    """The pitch correction by the level edges alone; None where their best is the largest that was tried."""
    shifts = pitch + LEVEL
    votes = np.array([edges.agreement(roll, shift) for shift in shifts.tolist()]).T
    drawn = [_refined(each, int(np.argmax(each)), shifts) for each in _drawn(votes)]
    place = int(np.argmax(votes.sum(axis=0)))
    if not 0 < place < len(LEVEL) - 1:
        return None
    return Angle(_refined(votes.sum(axis=0), place, shifts), float(np.std(drawn)))


def _both(vertical: Angle, level: Angle | None) -> Angle:
    """The mean of two opinions by their certainty where they agree, else the verticals'."""
    if level is None or abs(level.correction - vertical.correction) > AGREES_RAD:
        return vertical
    first, second = (1 / max(one.sd, LEAST_SD_RAD) ** 2 for one in (vertical, level))
    mean = (first * vertical.correction + second * level.correction) / (first + second)
    return Angle(float(mean), min(vertical.sd, level.sd), vertical.at_limit)


def _agreement(normal: Floats, weight: Floats, frame: NDArray[np.int64], up: Floats) -> Floats:
    """(frames,) how well edges agree modulo 90 degrees in azimuth if all were level.

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
    return np.asarray(np.max(smooth, axis=1))


def _peak(votes: Floats, rolls: Floats, pitches: Floats) -> tuple[float, float]:
    """Roll and pitch of the most votes, rad, between the grid's points."""
    i, j = (int(k) for k in np.unravel_index(np.argmax(votes), votes.shape))
    return _refined(votes[:, j], i, rolls), _refined(votes[i], j, pitches)


def _refined(votes: Floats, place: int, grid: Floats) -> float:
    """The top of the parabola through a maximum and its neighbours."""
    if not 0 < place < len(votes) - 1:
        return float(grid[place])
    before, top, after = votes[place - 1 : place + 2].tolist()
    bend = before - 2 * top + after
    return float(grid[place] + (0.5 * (before - after) / bend if bend else 0.0) * (grid[1] - grid[0]))


def _drawn(votes: Floats) -> Iterator[Floats]:
    """The votes of all frames when parts of the recording are drawn anew (block bootstrap)."""
    draws = np.random.default_rng(0)
    parts = np.array([part.sum(axis=0) for part in np.array_split(votes, min(PARTS, len(votes)))])
    for _ in range(RESAMPLES):
        times = np.bincount(draws.integers(0, len(parts), len(parts)), minlength=len(parts))
        yield np.tensordot(times.astype(np.float64), parts, axes=1)


def _spread(votes: Floats, rolls: Floats, pitches: Floats) -> Floats:
    """(2,) standard deviations of the peak's roll and pitch."""
    return np.asarray(np.std([_peak(drawn, rolls, pitches) for drawn in _drawn(votes)], axis=0))


def _leaps(rough: Floats) -> Floats:
    """(2,) standard deviations of the coarse peak as far as it leaps by more than a step."""
    best = np.array(np.unravel_index(np.argmax(rough.sum(axis=0)), rough.shape[1:]))
    places = np.array([np.unravel_index(np.argmax(drawn), drawn.shape) for drawn in _drawn(rough)])
    far = np.maximum(np.abs(places - best) - 1, 0) * (COARSE[1] - COARSE[0])
    return np.asarray(np.sqrt(np.square(far).mean(axis=0)))
