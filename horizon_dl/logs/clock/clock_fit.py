"""Where between two clocks the turns agree: offset, drift over long films, and how sure that is.

The turns that the pictures show are correlated with those of the log, over all offsets, in windows of some
seconds. A line through the windows' best offsets is offset and drift. The doubt is the jackknife's: how far
the result moves when a part of the pictures is left out; and what is common to all pictures is added.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.logs.clock.line import ON_LINE_S, line_through, refined_line
from horizon_dl.logs.clock.windows import LEAST_PAIRS, LONG_S, Window, peaks

Floats = NDArray[np.float64]

LEAST_CORRELATION = 0.4
LEAST_LEAD = 0.1
"""By which the best correlation must lead those at other offsets."""
PARTS = 8
SYSTEMATIC_FRAMES = 0.15
"""A stamp may be of the start or the end of an exposure, and rows are read out one after the other: what all
pictures share is within about half a frame, evenly, of which this is the standard deviation. No part of the
pictures left out shows it."""


@dataclass(frozen=True)
class ClockFit:
    """The frames' clock against the log's.

    Attributes:
        offset_s: to be added to the log's times, at the log's start.
        drift_ppm: by how much the frames' clock is faster, millionths; 0 for short films.
        doubt_s: standard error of the offset in the middle of the film, with what all pictures share, and
            as far as other offsets reach that are nearly as good.
        drift_doubt_ppm: of the drift; None for short films.
        correlation: of the turns, in [-1, 1].
        lead: over the best correlation at an offset elsewhere.
        frame_s: usual time between frames.
        pairs: of pictures compared.
    """

    offset_s: float
    drift_ppm: float
    doubt_s: float
    drift_doubt_ppm: float | None
    correlation: float
    lead: float
    frame_s: float
    pairs: int

    @property
    def sure(self) -> bool:
        """Fit to be used without a human's look: within half a frame, alone, and well correlated."""
        alone = self.correlation >= LEAST_CORRELATION and self.lead >= LEAST_LEAD
        return alone and self.doubt_s < self.frame_s / 2


def fit_clock(window: Window, nearest_s: float | None = None) -> ClockFit | None:
    """Offset and drift; None where too few pictures turn together with the log to tell.

    Args:
        window: all pairs of pictures with the log.
        nearest_s: see `peaks`.
    """
    good = np.isfinite(window.seen).all(axis=1)
    if good.sum() < LEAST_PAIRS or len(window.log_times_s) < 3:
        return None
    window = Window(
        window.starts_s[good],
        window.ends_s[good],
        _tamed(window.seen[good]),
        window.log_times_s,
        window.logged,
    )
    frame_s = float(np.median(window.ends_s - window.starts_s))
    found = [peaks(one, frame_s, nearest_s) for one in window.split()]
    line = line_through(found)
    if line is None:
        return None
    line = refined_line(window, line, frame_s)
    parts = [refined_line(window.without(part, PARTS), line, frame_s) for part in range(PARTS)]
    middle = float(np.median(window.starts_s))
    long = float(np.ptp(window.starts_s)) > LONG_S
    offset_s, excess = line.on_log_clock(float(window.log_times_s[0]))
    lead = float(
        np.mean([one.near(float(line.at(one.time_s)), ON_LINE_S) for one in found])
        - np.mean([one.elsewhere(float(line.at(one.time_s))) for one in found])
    )
    doubt_s = np.hypot(_jackknife([float(part.at(middle)) for part in parts]), SYSTEMATIC_FRAMES * frame_s)
    if lead < LEAST_LEAD:
        doubt_s += max(one.rival_s(float(line.at(one.time_s)), LEAST_LEAD) for one in found)
    return ClockFit(
        offset_s=offset_s,
        drift_ppm=excess * 1e6,
        doubt_s=float(doubt_s),
        drift_doubt_ppm=_jackknife([part.drift for part in parts]) * 1e6 if long else None,
        correlation=window.correlation(line.at(window.starts_s)),
        lead=lead,
        frame_s=frame_s,
        pairs=int(good.sum()),
    )


def _tamed(seen: Floats) -> Floats:
    """Turns clipped at four times the usual one: the measurement fails wildly now and then."""
    usual = np.median(np.linalg.norm(seen, axis=1)) + 1e-6
    return np.asarray(np.clip(seen, -4 * usual, 4 * usual))


def _jackknife(values: list[float]) -> float:
    count = len(values)
    return float(np.sqrt((count - 1) / count * np.sum((np.array(values) - np.mean(values)) ** 2)))
