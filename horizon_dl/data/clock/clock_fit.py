"""Where between two clocks the turns agree: offset, drift over long films, and how sure that is.

The turns that the pictures show are correlated with those of the log, over all offsets, in windows of some seconds.
A line through the windows' best offsets is offset and drift. The doubt is the jackknife's: how far the result moves
when a part of the pictures is left out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.clock.windows import Line, Window, line_through, peaks

Floats = NDArray[np.float64]

LEAST_PAIRS = 20
LEAST_CORRELATION = 0.4
LEAST_LEAD = 0.1
"""By which the best correlation must lead those at other offsets."""
PARTS = 8
LEAST_DRIFT_SPAN_S = 60.0


@dataclass(frozen=True)
class ClockFit:
    """The frames' clock against the log's.

    Attributes:
        offset_s: to be added to the log's times, at the log's start.
        drift_ppm: by how much the frames' clock is faster; 0 for short films.
        doubt_s: standard error of the offset in the middle of the film.
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
        """Fit to be used without being asked: within half a frame, alone, and well correlated."""
        return (
            self.correlation >= LEAST_CORRELATION
            and self.lead >= LEAST_LEAD
            and self.doubt_s < self.frame_s / 2
        )


@dataclass(frozen=True)
class Turns:
    """Turns seen from picture to picture, with the log's.

    Attributes:
        starts_s, ends_s: (n,) times of the two pictures of each pair, s, frames' clock.
        seen: (n, 3) rad, NaN where unknown.
        ups: (n, 3) the world's up in the optical frame as far as it is known, if the heading is not; else None.
        log_times_s: (N,) s, log's clock.
        logged: (N, 3) rad, sums of `logged_turns`.
    """

    starts_s: Floats
    ends_s: Floats
    seen: Floats
    log_times_s: Floats
    logged: Floats
    heading: bool


def fit_clock(turns: Turns, most_offset_s: float | None = None) -> ClockFit | None:
    """Offset and drift; None where too few pictures turn together with the log to tell.

    Args:
        turns: of the pictures and the log.
        most_offset_s: offsets beyond are not tried; None: all at which film and log share half of the film.
    """
    good = np.isfinite(turns.seen).all(axis=1)
    if good.sum() < LEAST_PAIRS or len(turns.log_times_s) < 3:
        return None
    window = Window(
        turns.starts_s[good], turns.ends_s[good], _tamed(turns.seen[good]), turns.log_times_s, turns.logged
    )
    frame_s = float(np.median(window.ends_s - window.starts_s))
    windows = window.split()
    found = [peaks(one, frame_s, most_offset_s) for one in windows]
    line = line_through([one for one in found if one], LEAST_DRIFT_SPAN_S)
    if line is None:
        return None
    line = window.refined(line, frame_s)
    parts = [window.without(part, PARTS).refined(line, frame_s) for part in range(PARTS)]
    middle = float(np.median(window.starts_s))
    doubt_s = _jackknife([part.at(middle) for part in parts])
    drifting = line.drift != 0.0
    log_start = float(turns.log_times_s[0])
    correlation = window.correlation(line)
    lead = correlation - max((other for one in found for other in one.others(line)), default=0.0)
    return ClockFit(
        offset_s=line.at_log(log_start),
        drift_ppm=line.drift * 1e6,
        doubt_s=max(doubt_s, frame_s / 50),
        drift_doubt_ppm=_jackknife([part.drift for part in parts]) * 1e6 if drifting else None,
        correlation=correlation,
        lead=lead,
        frame_s=frame_s,
        pairs=int(good.sum()),
    )


def _tamed(seen: Floats) -> Floats:
    """Turns clipped at eight times the usual one: the measurement fails wildly now and then."""
    usual = np.median(np.abs(seen), axis=0) + 1e-6
    return np.asarray(np.clip(seen, -8 * usual, 8 * usual))


def _jackknife(values: list[float]) -> float:
    count = len(values)
    return float(np.sqrt((count - 1) / count * np.sum((np.array(values) - np.mean(values)) ** 2)))
