"""Sectors of the last frames, turned by the known rotation and joined."""

from collections import deque
from dataclasses import dataclass, fields

import numpy as np

from horizon_dl.ranging.sectors import FreeDistances, no_distances


@dataclass(frozen=True)
class _Past:
    time_s: float
    yaw_rad: float
    found: FreeDistances


class SectorFilter:
    """Median over the last frames of what each direction in the world showed.

    What appears or vanishes shows after half of the frames: with 3 frames, one frame late (`delay_s`). Turns
    are undone by the yaw; the distance travelled meanwhile is not: they are up to speed x age too long.

    Args:
        frames: an odd number; 1 filters nothing.
        max_age_s: frames older than this are forgotten.
        gap_s: after a longer gap between two frames, those before it say nothing any more.

    Raises:
        ValueError: `frames` is even or not positive.
    """

    def __init__(self, frames: int = 3, max_age_s: float = 0.5, gap_s: float = 0.3) -> None:
        if frames < 1 or frames % 2 == 0:
            raise ValueError(f"a median needs an odd number of frames, not {frames}")
        self._past: deque[_Past] = deque(maxlen=frames)
        self._max_age_s, self._gap_s = max_age_s, gap_s

    @property
    def delay_s(self) -> float:
        """Age of the middle frame now held: how late a change shows; 0 before two frames."""
        if len(self._past) < 2:
            return 0.0
        return self._past[-1].time_s - self._past[-1 - len(self._past) // 2].time_s

    def add(self, time_s: float, yaw_rad: float, found: FreeDistances) -> FreeDistances:
        """The sectors now, joined with those of the frames before.

        Each sector takes over one of the measurements whole: the median by depression, of an even number the
        nearer one. A direction that the newest frame does not see stays unknown.

        Args:
            time_s: of the frame, not falling.
            yaw_rad: of the body, clockwise from north; only differences count.
            found: sectors of equal width, the same in every frame.
        """
        if self._past and time_s - self._past[-1].time_s > self._gap_s:
            self._past.clear()
        while self._past and time_s - self._past[0].time_s > self._max_age_s:
            self._past.popleft()
        self._past.append(_Past(time_s, yaw_rad, found))
        turned = [_turned(past.found, yaw_rad - past.yaw_rad) for past in self._past]
        depression = np.stack([one.depression_rad for one in turned])
        order = np.argsort(depression, axis=0, kind="stable")  # NaN, the unknown, goes last
        known = np.sum(~np.isnan(depression), axis=0)
        chosen = np.take_along_axis(order, (known // 2)[None] % len(turned), axis=0)[0]
        chosen = np.where(np.isnan(found.depression_rad), len(turned) - 1, chosen)
        return _picked(turned, chosen)


def _turned(found: FreeDistances, turn_rad: float) -> FreeDistances:
    """What the sectors would show after the body turned clockwise by `turn_rad`; unknown where outside."""
    bearing = found.bearing_rad
    if len(bearing) < 2:
        return found if turn_rad == 0 else no_distances(bearing)
    step = float(bearing[1] - bearing[0])
    turn = float(np.remainder(turn_rad + np.pi, 2 * np.pi) - np.pi)
    source = np.arange(len(bearing)) + round(turn / step)
    inside = (source >= 0) & (source < len(bearing))
    pick = np.clip(source, 0, len(bearing) - 1)
    nothing = no_distances(bearing)
    values = {
        field.name: np.where(inside, getattr(found, field.name)[pick], getattr(nothing, field.name))
        for field in fields(FreeDistances)
    }
    return FreeDistances(**{**values, "bearing_rad": bearing})


def _picked(options: list[FreeDistances], chosen: np.ndarray) -> FreeDistances:
    """Each sector from the option that was chosen for it."""
    sectors = np.arange(len(chosen))
    return FreeDistances(
        **{
            field.name: np.stack([getattr(option, field.name) for option in options])[chosen, sectors]
            for field in fields(FreeDistances)
        }
    )
