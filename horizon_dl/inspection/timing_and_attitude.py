"""What the entries of a recording tell without reading an image: times, attitudes, horizon, names."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.source import Recording
from horizon_dl.geometry.horizon import elevation, horizon_label

Floats = NDArray[np.float64]
COARSE_PIXELS = 2400  # one number a frame is needed, from every frame of long recordings
GAP_MEDIANS = 5.0


@dataclass(frozen=True)
class Timing:
    """Times of a recording, seconds; `rate_hz` is None where no two times differ."""

    duration_s: float
    rate_hz: float | None
    gaps: int
    longest_gap_s: float
    longest_gap_after: str
    repeated: int
    backwards: int


@dataclass(frozen=True)
class Percentiles:
    """5th, 50th and 95th percentile."""

    p5: float
    p50: float
    p95: float

    @property
    def spread(self) -> float:
        """From the 5th to the 95th."""
        return self.p95 - self.p5


@dataclass(frozen=True)
class Attitudes:
    """The camera's attitude: roll clockwise, pitch of the optical axis over the horizon, degrees."""

    missing: int
    roll_deg: Percentiles
    pitch_deg: Percentiles


@dataclass(frozen=True)
class Labels:
    """Horizon labels of all entries with an attitude.

    Attributes:
        visible_share: frames with at least 1 % of the pixels on each side of the horizon.
        above, below, ignored: mean shares of the pixels; pixels without a valid ray count for none.
        valid_rays: share of the image's pixels with a valid ray.
        travel: 5th to 95th percentile of the horizon's row in the middle column, in image heights.
        fixed_line_accuracy: share of the labels that the best image drawn once would get right: what a net
            that only reads the position could reach.
    """

    visible_share: float
    above: float
    below: float
    ignored: float
    valid_rays: float
    travel: float
    fixed_line_accuracy: float


def percentiles(values: Floats) -> Percentiles:
    """Percentiles of some values, (n,) with n > 0."""
    return Percentiles(*(float(value) for value in np.percentile(values, (5, 50, 95))))


def timing(entries: Sequence[FrameHeader]) -> Timing:
    """Rate, gaps (over five times the usual step), repeated times, and steps back by order or by name."""
    times = np.array([entry.time_s for entry in entries], np.float64)
    steps = np.diff(times)
    forward = steps[steps > 0]
    usual = float(np.median(forward)) if len(forward) else 0.0
    gaps = np.flatnonzero(steps > GAP_MEDIANS * usual) if usual else np.empty(0, np.int64)
    longest = int(gaps[np.argmax(steps[gaps])]) if len(gaps) else -1
    return Timing(
        duration_s=float(times.max() - times.min()) if len(times) else 0.0,
        rate_hz=1.0 / usual if usual else None,
        gaps=len(gaps),
        longest_gap_s=float(steps[longest]) if len(gaps) else 0.0,
        longest_gap_after=entries[longest].name if len(gaps) else "",
        repeated=int((steps == 0).sum()),
        backwards=max(int((steps < 0).sum()), _steps_back_by_name(entries)),
    )


def _steps_back_by_name(entries: Sequence[FrameHeader]) -> int:
    """Names that count upwards but whose times jump back; 0 where names do not follow the time at all.

    Readers sort by time, so a clock that was set back shows only as names in the wrong order.
    """
    numbers = [re.findall(r"\d+", entry.name.rsplit("/", 1)[-1]) for entry in entries]
    if len(entries) < 3 or not all(numbers) or len({entry.name.count("/") for entry in entries}) > 1:
        return 0
    order = sorted(range(len(entries)), key=lambda index: [int(number) for number in numbers[index]])
    times = np.array([entries[index].time_s for index in order])
    back = int((np.diff(times) < 0).sum())
    return back if back <= 0.1 * len(entries) + 1 else 0


def camera_angles_deg(ups_cam: Floats) -> tuple[Floats, Floats]:
    """Roll (clockwise positive) and pitch of the optical axis (up positive), degrees, of (n, 3) up_cam."""
    roll = np.arctan2(0.0 - ups_cam[:, 0], 0.0 - ups_cam[:, 1])
    pitch = np.arcsin(np.clip(ups_cam[:, 2], -1.0, 1.0))
    return np.rad2deg(roll), np.rad2deg(pitch)


def known_ups(entries: Sequence[FrameHeader]) -> Floats:
    """(n, 3) up_cam of the entries that have a finite one."""
    ups = [entry.up_cam for entry in entries if entry.up_cam is not None and np.isfinite(entry.up_cam).all()]
    return np.array(ups, np.float64).reshape(-1, 3)


def attitudes(entries: Sequence[FrameHeader]) -> Attitudes | None:
    """Range of the camera's attitudes; None where no entry has one."""
    ups = known_ups(entries)
    if not len(ups):
        return None
    roll_deg, pitch_deg = camera_angles_deg(ups)
    return Attitudes(len(entries) - len(ups), percentiles(roll_deg), percentiles(pitch_deg))


def label_statistics(recording: Recording, band_rad: float) -> Labels | None:
    """Horizon labels of all entries, on a coarse grid of pixels; None where no entry has an attitude."""
    from horizon_dl.geometry.rays import camera_rays

    ups = known_ups(recording.headers)
    if not len(ups):
        return None
    rays = camera_rays(recording.calibrated.reduced(COARSE_PIXELS))
    valid = max(int(rays.valid.sum()), 1)
    shares = np.zeros((len(ups), 3))
    visible = np.zeros(len(ups), bool)
    rows = np.full(len(ups), np.nan)
    above_count = np.zeros(rays.valid.shape)
    for index, up_cam in enumerate(ups):
        angle = elevation(rays.directions, up_cam)
        label = horizon_label(angle, band_rad)[rays.valid]
        shares[index] = [(label == 1).sum(), (label == 0).sum(), (label == 255).sum()]
        above = angle > 0
        above_count += above
        visible[index] = 0.01 <= above.sum() / valid <= 0.99
        rows[index] = _horizon_row(angle[:, angle.shape[1] // 2])
    shares /= valid
    p_above = above_count[rays.valid] / len(ups)
    return Labels(
        visible_share=float(visible.mean()),
        above=float(shares[:, 0].mean()),
        below=float(shares[:, 1].mean()),
        ignored=float(shares[:, 2].mean()),
        valid_rays=float(rays.valid.mean()),
        travel=percentiles(rows[~np.isnan(rows)]).spread if (~np.isnan(rows)).any() else 0.0,
        fixed_line_accuracy=float(np.maximum(p_above, 1 - p_above).mean()) if len(p_above) else 0.0,
    )


def _horizon_row(column: NDArray[np.float32]) -> float:
    """Where the elevation of a column of pixels crosses zero, in image heights; NaN where it does not."""
    crossings = np.flatnonzero(np.diff(column > 0) & np.isfinite(column[1:]) & np.isfinite(column[:-1]))
    if not len(crossings):
        return float("nan")
    first = int(crossings[0])
    return float((first + column[first] / (column[first] - column[first + 1])) / len(column))
