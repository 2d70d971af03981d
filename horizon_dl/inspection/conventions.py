"""Which way of reading the attitude agrees with the turns that the pictures show.

A turn of the camera carries the world's up from where it lies in one optical frame to where it lies in the
next. Whatever way of reading an attitude is right gives ups that the seen turns carry into one another; the
others do not, once the camera has turned about two axes. The mount is left free within 40 degrees of the
stated one, so that an error of it is not taken for a convention's. That does not tell up from down (both are
carried alike): pictures are taken to be stored upright.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.convention import Convention, Reading
from horizon_dl.geometry.axes import frd_from_axes
from horizon_dl.inspection.convention_candidates import changes as changes_of
from horizon_dl.inspection.convention_candidates import conventions
from horizon_dl.inspection.turns import Turns

Floats = NDArray[np.float64]

CAP_RAD = np.radians(10.0)
MOST_MOUNT_RAD = np.radians(40.0)
MOST_TILT_RAD = np.radians(60.0)
LEAST_PAIRS, FEWEST_PAIRS = 20, 6
FINALISTS = 16
SURE = 3.0
"""Standard deviations by which a reading has to be better than the stated one."""
BETTER = 0.7
"""And its misses smaller by this factor."""
AS_GOOD = 1.15
MANY_CHANGES, MANY_NO_MOTION = 3.0, 0.5
"""An explanation with many parts needs more of a motion to be believed."""
NO_MOTION = 0.75
"""Misses over this part of the ups' own motion: nothing fits, or there is too little motion to say so."""


@dataclass(frozen=True)
class Fit:
    """How well one reading agrees with the pictures.

    Attributes:
        convention: the reading.
        misses_rad: (P,) angle between where a turn carries up and where it is read to be; at most 10 degrees.
        mount_error_rad: rotation vector (3,) in the optical frame that makes them smallest.
    """

    convention: Convention
    misses_rad: Floats
    mount_error_rad: Floats

    @property
    def miss_rad(self) -> float:
        """The mean."""
        return float(self.misses_rad.mean())


@dataclass(frozen=True)
class ConventionFit:
    """The stated reading, the best one, and whether the pictures tell them apart.

    Attributes:
        stated, best: of the readings; the same where the stated one is as good as any.
        motion_rad: mean motion of up in the camera, which a reading that knows nothing would miss by.
        pairs: of frames.
        sure: the stated reading is wrong.
        told: the pictures move enough to say anything.
        turned: pictures that are stored on their side would explain it as well.
    """

    stated: Fit
    best: Fit
    motion_rad: float
    pairs: int
    sure: bool
    told: bool
    turned: bool = False


def fit_conventions(
    turns: Turns, as_read: Sequence[tuple[float, ...] | None], reading: Reading
) -> ConventionFit | None:
    """Tries every convention; None with too few pairs of frames.

    Args:
        turns: seen in the pictures.
        as_read: the attitude's numbers of each frame.
        reading: as stated.
    """
    width = next((len(one) for one in as_read if one is not None), 0)
    numbers = np.array([(np.nan,) * width if one is None else one for one in as_read], np.float64)
    if not width or not len(turns.first):
        return None
    good = np.isfinite(numbers[turns.first]).all(-1) & np.isfinite(numbers[turns.second]).all(-1)
    if good.sum() < LEAST_PAIRS:
        return None
    kept = turns.select(np.asarray(good))
    ups_of = _Ups(numbers, reading.mount)
    stated = _fitted(kept, reading.convention, ups_of(reading.convention))
    rough = []
    for convention in conventions(reading.convention, width == 4):
        ups = ups_of(convention)
        if _tilt_rad(ups) < MOST_TILT_RAD:  # pictures are stored upright
            rough.append((float(_misses(kept, ups).mean()), convention))
    rough.sort(key=lambda row: row[0])
    fits = [_fitted(kept, convention, ups_of(convention)) for _, convention in rough[:FINALISTS]]
    least = min([stated.miss_rad, *(fit.miss_rad for fit in fits)])
    alike = [fit for fit in [stated, *fits] if fit.miss_rad <= AS_GOOD * least + 1e-9]
    lies = _lies_wrong(ups_of(reading.convention))
    candidates = [fit for fit in alike if fit is not stated or not lies] or alike
    best = min(
        candidates, key=lambda fit: (changes_of(fit.convention, stated.convention, width == 4), fit.miss_rad)
    )
    motion = float(_motion(kept, ups_of(best.convention)).mean())
    changes = changes_of(best.convention, stated.convention, width == 4)
    told = best.miss_rad < (NO_MOTION if changes < MANY_CHANGES else MANY_NO_MOTION) * motion
    much_better = best.miss_rad < BETTER * stated.miss_rad
    worse = much_better and _lead(kept, stated, best) > SURE
    sure = told and best.convention != reading.convention and (worse or lies)
    told = told and (sure or not much_better)  # another reading is much better, and it may be chance
    turned = sure and not worse and _on_its_side(ups_of(stated.convention))
    return ConventionFit(stated, best if sure else stated, motion, int(good.sum()), sure, told, turned)


def fit_ups(turns: Turns, ups: Floats) -> Fit | None:
    """How well ups (N, 3) agree with the turns; None with too few pairs, or of no upright picture."""
    good = np.isfinite(ups[turns.first]).all(-1) & np.isfinite(ups[turns.second]).all(-1)
    if good.sum() < FEWEST_PAIRS or _tilt_rad(ups) > MOST_TILT_RAD:
        return None
    kept = turns.select(np.asarray(good))
    return _fitted(kept, Convention(), ups)


def motion_of(turns: Turns, ups: Floats) -> float:
    """Mean angle, rad, by which the turns move given ups (N, 3)."""
    return float(np.nanmean(_motion(turns, ups)))


class _Ups:
    """Up in the camera of all frames under any convention; each kind of rotation is made once."""

    def __init__(self, numbers: Floats, camera_from_frd: Floats) -> None:
        self._numbers, self._camera_from_frd = numbers, camera_from_frd
        self._rotations: dict[tuple[str, str], Floats] = {}

    def __call__(self, convention: Convention) -> Floats:
        key = convention.order, convention.unit
        if key not in self._rotations:
            self._rotations[key] = convention.rotations(self._numbers)
        turn = self._camera_from_frd @ frd_from_axes(convention.body, left_handed=True)
        return np.asarray(convention.ups_of(self._rotations[key]) @ turn.T)


def _tilt_rad(ups: Floats) -> float:
    """Angle between up, in the mean, and the picture's own up."""
    mean = np.nanmean(ups, axis=0)
    return float(np.arccos(np.clip(-mean[1] / max(float(np.linalg.norm(mean)), 1e-12), -1.0, 1.0)))


def _lies_wrong(ups: Floats) -> bool:
    """Whether up is read to lie where it lies in no upright picture."""
    return float(np.linalg.norm(np.nanmean(ups, axis=0))) < 0.5 or _tilt_rad(ups) > MOST_TILT_RAD


def _on_its_side(ups: Floats) -> bool:
    """Whether up is read to lie along the picture's rows, or down: as where it is stored turned."""
    x, y, z = np.abs(np.nanmean(ups, axis=0)).tolist()
    return _lies_wrong(ups) and z < 0.5 and min(x, y) < 0.4 * max(x, y)


def _misses(turns: Turns, ups: Floats) -> Floats:
    carried = np.einsum("pij,pj->pi", turns.rotation, ups[turns.first])
    chord = np.linalg.norm(carried - ups[turns.second], axis=-1)
    return np.asarray(np.minimum(2 * np.arcsin(np.clip(chord / 2, 0.0, 1.0)), CAP_RAD))


def _motion(turns: Turns, ups: Floats) -> Floats:
    """How far the seen turns move up in the camera."""
    carried = np.einsum("pij,pj->pi", turns.rotation, ups[turns.first])
    chord = np.linalg.norm(carried - ups[turns.first], axis=-1)
    return np.asarray(np.minimum(2 * np.arcsin(np.clip(chord / 2, 0.0, 1.0)), CAP_RAD))


def _fitted(turns: Turns, convention: Convention, ups: Floats) -> Fit:
    """The misses under the mount that makes them smallest."""
    from scipy.optimize import minimize
    from scipy.spatial.transform import Rotation

    def cost(vector: Floats) -> float:
        beyond = max(0.0, float(np.linalg.norm(vector)) - MOST_MOUNT_RAD)
        turned = ups @ Rotation.from_rotvec(vector).as_matrix().T
        return float(_misses(turns, turned).mean() + beyond)

    starts = np.radians(np.array([[0, 0, 0], [20, 0, 0], [-20, 0, 0], [0, 0, 20], [0, 0, -20]], np.float64))
    start = min(starts, key=cost)
    simplex = np.vstack([start, start + np.radians(8.0) * np.eye(3)])
    found = minimize(
        cost, start, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": 150, "xatol": 1e-3}
    )
    vector = np.asarray(found.x)
    return Fit(convention, _misses(turns, ups @ Rotation.from_rotvec(vector).as_matrix().T), vector)


def _lead(turns: Turns, stated: Fit, best: Fit) -> float:
    """By how many standard deviations the best is better, over the turns from frame to frame."""
    gains = (stated.misses_rad - best.misses_rad)[turns.second == turns.first + 1]
    return float(gains.mean() / max(gains.std() / np.sqrt(max(len(gains), 1)), 1e-12))
