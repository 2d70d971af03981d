"""Turns in windows of time: their correlation over offsets, and the line through the windows' offsets."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LONG_S, WINDOW_S = 60.0, 10.0
"""Films longer than the first are cut into windows of the second; between those, clocks drift apart."""
LEAST_PAIRS = 20
MOST_PEAKS = 5
APART_S = 0.5
"""Peaks of the correlation nearer to each other are one."""
LEAST_COVER = 0.5


@dataclass(frozen=True)
class Peaks:
    """Offsets (k,) s of a window's highest correlations (k,), the highest first."""

    time_s: float
    offsets_s: Floats
    correlations: Floats

    def near(self, offset_s: float, within_s: float) -> float:
        """The highest correlation at an offset, 0 where there is no peak."""
        here = np.abs(self.offsets_s - offset_s) <= within_s
        return float(self.correlations[here].max()) if here.any() else 0.0

    def elsewhere(self, offset_s: float) -> float:
        """The highest correlation at another offset."""
        other = np.abs(self.offsets_s - offset_s) > APART_S
        return float(self.correlations[other].max()) if other.any() else 0.0

    def rival_s(self, offset_s: float, lead: float) -> float:
        """How far the furthest other offset is that is as good but for a lead, s; 0 where none is."""
        apart = np.abs(self.offsets_s - offset_s)
        rival = (apart > APART_S) & (self.correlations > self.near(offset_s, APART_S) - lead)
        return float(apart[rival].max()) if rival.any() else 0.0


@dataclass(frozen=True)
class Window:
    """Pairs of pictures with the turns (n, 3) seen between them, and all the log's summed turns (N, 3)."""

    starts_s: Floats
    ends_s: Floats
    seen: Floats
    log_times_s: Floats
    logged: Floats

    @property
    def time_s(self) -> float:
        """In its middle, frames' clock."""
        return float(self.starts_s[0] + self.ends_s[-1]) / 2

    def split(self) -> list["Window"]:
        """Itself where it is short, else parts of ten seconds; those with few pairs are left out."""
        since = self.starts_s - self.starts_s[0]
        if since[-1] <= LONG_S:
            return [self]
        part = (since / WINDOW_S).astype(np.int64)
        parts = [self._where(part == number) for number in np.unique(part)]
        return [one for one in parts if len(one.starts_s) >= LEAST_PAIRS]

    def without(self, part: int, parts: int) -> "Window":
        """All but one of some parts, for the jackknife."""
        return self._where(np.arange(len(self.starts_s)) * parts // len(self.starts_s) != part)

    def correlation(self, offsets_s: Floats | float) -> float:
        """Of the seen turns and the log's at an offset (of each pair), in [-1, 1]; 0 where unknown."""
        before, after = self.starts_s - offsets_s, self.ends_s - offsets_s
        inside = (before >= self.log_times_s[0]) & (after <= self.log_times_s[-1])
        if inside.sum() < LEAST_COVER * len(inside):
            return 0.0
        told = self.told(before[inside], after[inside])
        seen = self.seen[inside]
        size = float(np.sqrt((seen**2).sum() * (told**2).sum()))
        return float((seen * told).sum()) / size if size > 0 else 0.0

    def told(self, before_s: Floats, after_s: Floats) -> Floats:
        """The log's turns (n, 3) between times of its own clock, rad."""
        times_s, axes = self.log_times_s, self.logged.T
        turns = [np.interp(after_s, times_s, axis) - np.interp(before_s, times_s, axis) for axis in axes]
        return np.stack(turns, axis=-1)

    def refined(self, offset_s: float, frame_s: float) -> float:
        """The offset of the highest correlation within a frame and a half, s."""
        tried = offset_s + frame_s * np.linspace(-1.5, 1.5, 13)
        scores = np.array([self.correlation(one) for one in tried])
        best = int(np.clip(scores.argmax(), 1, len(tried) - 2))
        left, top, right = scores[best - 1 : best + 2]
        bend = left - 2 * top + right
        part = 0.5 * (left - right) / bend if bend < 0 else 0.0
        return float(tried[best] + np.clip(part, -1, 1) * (tried[1] - tried[0]))

    def _where(self, chosen: NDArray[np.bool_]) -> "Window":
        return replace(
            self, starts_s=self.starts_s[chosen], ends_s=self.ends_s[chosen], seen=self.seen[chosen]
        )


def peaks(window: Window, frame_s: float, nearest_s: float | None = None) -> Peaks:
    """The offsets at which a window's turns agree best with the log's.

    Args:
        window: of pairs.
        frame_s: usual time between frames; half of it is the grid.
        nearest_s: greatest offset that is tried; None: all at which half of the window lies in the log.
    """
    step = frame_s / 2
    first, start = float(window.starts_s[0]), float(window.log_times_s[0])
    grid = np.arange(start, window.log_times_s[-1], step)
    told = (
        np.stack(
            [
                np.interp(grid + step, window.log_times_s, axis)
                - np.interp(grid - step, window.log_times_s, axis)
                for axis in window.logged.T
            ],
            axis=-1,
        )
        / frame_s
    )
    times_s = np.arange(first, window.ends_s[-1], step)
    pair = np.clip(np.searchsorted(window.starts_s, times_s, side="right") - 1, 0, None)
    known = times_s < window.ends_s[pair]
    rate = window.seen[pair] / (window.ends_s - window.starts_s)[pair, None] * known[:, None]
    size = len(grid) + len(times_s)
    product = sum(_correlated(rate[:, axis], told[:, axis], size) for axis in range(3))
    cover = _correlated(known.astype(np.float64), np.ones(len(grid)), size)
    power = _correlated(known.astype(np.float64), (told**2).sum(axis=1), size)
    own = _correlated((rate**2).sum(axis=1), np.ones(len(grid)), size)
    with np.errstate(invalid="ignore", divide="ignore"):
        score = np.nan_to_num(product / np.sqrt(np.maximum(power, 0) * np.maximum(own, 0)))
    lags = np.where(np.arange(size) < len(grid), np.arange(size), np.arange(size) - size)
    offsets_s = first - start - lags * step
    usable = cover >= max(LEAST_COVER * known.sum(), LEAST_PAIRS)
    if nearest_s is not None:
        usable &= np.abs(offsets_s) <= nearest_s
    return _highest(np.where(usable, score, -1.0), offsets_s, window.time_s)


def _correlated(short: Floats, long: Floats, size: int) -> Floats:
    """Sums over j of `short[j] long[j + lag]`, negative lags at the end."""
    spectrum = np.conj(np.fft.rfft(short, size)) * np.fft.rfft(long, size)
    return np.fft.irfft(spectrum, size)


def _highest(score: Floats, offsets_s: Floats, time_s: float) -> Peaks:
    found: list[int] = []
    left = score.copy()
    for _ in range(MOST_PEAKS):
        best = int(left.argmax())
        if left[best] <= 0:
            break
        found.append(best)
        left[np.abs(offsets_s - offsets_s[best]) <= APART_S] = -1.0
    return Peaks(time_s, offsets_s[found], score[found])
