"""Whether the images move as the attitude says: finds wrong signs and clocks that are apart.

Between two successive images the scene moves up or down by what the camera pitched and rolled. That shift is
measured by phase correlation in the left and the right half of the image and compared with the shift that the
attitudes predict, also for attitudes some frames earlier and later.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import FrameHeader
from horizon_dl.geometry.camera import Camera

Floats = NDArray[np.float64]
Gray = NDArray[np.float32]
LEAST_PAIRS = 20
LEAST_SHIFT_PX = 0.7  # standard deviation of the predicted shifts, under which nothing can be said
MOST_LAG_S = 1.0
MOST_LAG_FRAMES = 8


@dataclass(frozen=True)
class MotionFit:
    """Agreement of measured and predicted vertical shifts of the scene.

    Attributes:
        correlation: of ranks (Spearman: phase correlation fails wildly now and then), with the attitudes as
            stated, in [-1, 1].
        best_correlation: over the lags tried.
        best_lag_s: the images fit the attitudes of that much later best; 0 as stated.
        pitch, roll: the correlation of the two halves' mean and of their difference; None where the camera
            hardly pitches or rolls.
        pairs: successive images compared.
    """

    correlation: float
    best_correlation: float
    best_lag_s: float
    pitch: float | None
    roll: float | None
    pairs: int


def predicted_shifts(entries: Sequence[FrameHeader], camera: Camera) -> Floats:
    """(n - 1, 2) shift in pixels (down positive) of the scene in the two halves, from entry to entry.

    A pixel of elevation e in one image is found in the next where the elevation is e again: the shift is the
    change of elevation over its slope down the image. NaN where an attitude is missing.

    Args:
        entries: of the recording, in order.
        camera: at the size in which shifts are measured.
    """
    from horizon_dl.geometry.rays import camera_rays

    directions = camera_rays(camera).directions.astype(np.float64)
    row, step = camera.height // 2, max(1, camera.height // 8)
    columns = [camera.width // 4, (3 * camera.width) // 4]
    ups = np.array([np.full(3, np.nan) if e.up_cam is None else e.up_cam for e in entries], np.float64)
    angle = np.arcsin(np.clip(ups @ directions[row, columns].T, -1, 1))
    upper = np.arcsin(np.clip(ups @ directions[row - step, columns].T, -1, 1))
    lower = np.arcsin(np.clip(ups @ directions[row + step, columns].T, -1, 1))
    slope = (lower - upper) / (2 * step)
    return np.asarray(-np.diff(angle, axis=0) / np.where(np.abs(slope[1:]) > 1e-6, slope[1:], np.nan))


def measured_shift(first: Gray, second: Gray) -> tuple[float, float]:
    """Shift in pixels (down positive) of the scene from one (h, w) grey image to the next, left and right."""
    half = first.shape[1] // 2
    left = _vertical_shift(first[:, :half], second[:, :half])
    return left, _vertical_shift(first[:, half:], second[:, half:])


def _vertical_shift(first: Gray, second: Gray) -> float:
    from skimage.registration import phase_cross_correlation

    window = np.outer(np.hanning(first.shape[0]), np.hanning(first.shape[1]))
    pair = [(image - image.mean()) * window for image in (first, second)]
    # The function gives the shift that takes the second image back to the first.
    shift, _, _ = phase_cross_correlation(pair[0], pair[1], upsample_factor=4)
    return -float(shift[0])


def motion_fit(
    measured: Floats, pairs: NDArray[np.int64], predicted: Floats, step_s: float | None, height: int
) -> MotionFit | None:
    """Correlates measured with predicted shifts over lags; None where the camera turns too little to tell.

    Args:
        measured: (m, 2) shifts of the pairs of images.
        pairs: (m,) index of the first entry of each pair.
        predicted: (n - 1, 2) of `predicted_shifts`.
        step_s: usual time between frames; None tries no lag.
        height: of the images; shifts over a quarter of it are not measurable.
    """
    most = min(MOST_LAG_FRAMES, int(MOST_LAG_S / step_s)) if step_s else 0
    lags = range(-most, most + 1)
    scores = {lag: _correlation(*_usable(measured, pairs + lag, predicted, height)) for lag in lags}
    stated = scores[0]
    if stated is None:
        return None
    best = max(scores, key=lambda lag: (scores[lag] or -1.0, -abs(lag)))
    found, expected = _usable(measured, pairs, predicted, height)
    pitch = _correlation(found.mean(axis=1), expected.mean(axis=1))
    roll = _correlation(np.diff(found).ravel(), np.diff(expected).ravel())
    return MotionFit(stated, scores[best] or stated, best * (step_s or 0.0), pitch, roll, len(found))


def _usable(
    measured: Floats, indices: NDArray[np.int64], predicted: Floats, height: int
) -> tuple[Floats, Floats]:
    """Measured and predicted shifts, (k, 2) each, of the pairs where both are known and not too large."""
    inside = (indices >= 0) & (indices < len(predicted))
    expected = predicted[np.clip(indices, 0, len(predicted) - 1)]
    good = inside & ((np.abs(expected) < height / 4) & (np.abs(measured) < height / 4)).all(axis=1)
    return measured[good], expected[good]


def _correlation(measured: Floats, expected: Floats) -> float | None:
    from scipy.stats import spearmanr

    if len(measured) < LEAST_PAIRS or expected.std() < LEAST_SHIFT_PX or measured.std() < 1e-6:
        return None
    return float(spearmanr(measured.ravel(), expected.ravel()).statistic)
